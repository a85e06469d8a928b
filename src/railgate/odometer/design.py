"""The odometer as engines run it: gateware, clock and model together."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from railgate.engines import Clock, Design, Model
from railgate.odometer.spec import Config

if TYPE_CHECKING:
    from amaranth.lib import wiring

__all__ = ["design"]


def design(config: Config) -> Design:
    """One odometer with its configuration's clock. Each side is imported only when it is run."""

    def component() -> wiring.Component:
        from railgate.odometer.gateware import Odometer

        return Odometer(config)

    def model() -> Model:
        from railgate.odometer.model import Model

        return Model(config)

    clock = Clock(frequency_hz=Fraction(config.clock_hz))
    return Design(name="odometer", component=component, clocks=(clock,), model=model)
