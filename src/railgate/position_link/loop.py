"""The position link with all that is outside its pins, as one component."""

from __future__ import annotations

from fractions import Fraction
from functools import partial

from amaranth.hdl import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.engines import Clock, Design
from railgate.position_link.gateware import PositionLink
from railgate.position_link.plant.gateware import Plant
from railgate.position_link.spec import Config

__all__ = ["Loop", "loop"]

PINS = ("uef", "data")


class Loop(wiring.Component):
    """A link whose position system answers as it is told.

    system, line: in, what they do, see Plant; Plan.controls drives them. clk, anf, delivery, one
    of each of config.fields, radio_valid, radio_data: out, the link's. uef, data: out, 1 bit, the
    link's pins. radio: out, what the radio unit has received, see Plant.
    """

    def __init__(self, config: Config) -> None:
        self._link, self._plant = PositionLink(config), Plant(config)
        link, plant = self._link.signature.members, self._plant.signature.members
        told = {name: member for name, member in link.items() if member.flow == Out}
        around = {name: plant[name] for name in ("system", "line", "radio")}
        super().__init__(told | {name: Out(1) for name in PINS} | around)

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.submodules.link = link = self._link
        m.submodules.plant = plant = self._plant
        for name, member in link.signature.members.items():
            if member.flow == In:
                m.d.comb += getattr(link, name).eq(getattr(plant, name))
            else:
                m.d.comb += getattr(self, name).eq(getattr(link, name))
        for name in ("clk", "anf", "radio_valid", "radio_data"):
            m.d.comb += getattr(plant, name).eq(getattr(link, name))
        for name in PINS:
            m.d.comb += getattr(self, name).eq(getattr(plant, name))
        for name in ("system", "line", "radio"):
            wiring.connect(m, wiring.flipped(getattr(self, name)), getattr(plant, name))
        return m


def loop(config: Config) -> Design:
    """The loop with its configuration's clock."""
    clock = Clock(frequency_hz=Fraction(config.clock_hz))
    return Design(name="position-link-loop", component=partial(Loop, config), clocks=(clock,))
