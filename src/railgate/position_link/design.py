"""The position link as engines run it: gateware, clock and model together."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from railgate.engines import Clock, Design, Model
from railgate.position_link.spec import Config

if TYPE_CHECKING:
    from amaranth.lib import wiring

__all__ = ["design"]


def design(config: Config) -> Design:
    """One position link with its configuration's clock. Each side is imported only when it is
    run."""

    def component() -> wiring.Component:
        from railgate.position_link.gateware import PositionLink

        return PositionLink(config)

    def model() -> Model:
        from railgate.position_link.model import Model

        return Model(config)

    clock = Clock(frequency_hz=Fraction(config.clock_hz))
    return Design(name="position_link", component=component, clocks=(clock,), model=model)
