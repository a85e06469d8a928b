"""One channel of the vital output as engines run it: gateware, clock and model together."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from railgate.engines import Clock, Design, Model
from railgate.vital_output.spec import Config

if TYPE_CHECKING:
    from amaranth.lib import wiring

__all__ = ["design"]


def design(config: Config, board: int = 0) -> Design:
    """The channel of this one of config.boards with its configuration's clock. Each side is
    imported only when it is run."""

    def component() -> wiring.Component:
        from railgate.vital_output.gateware import Channel

        return Channel(config, board)

    def model() -> Model:
        from railgate.vital_output.model import ChannelModel

        return ChannelModel(config, board)

    clock = Clock(frequency_hz=Fraction(config.clock_hz))
    return Design(name="vital-output-channel", component=component, clocks=(clock,), model=model)
