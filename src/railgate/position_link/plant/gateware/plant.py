"""All that is outside the link's pins."""

from __future__ import annotations

from amaranth.hdl import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.position_link.plant.gateware.line import DISTURBANCE, Line
from railgate.position_link.plant.gateware.radio import RadioUnit
from railgate.position_link.plant.gateware.system import PositionSystem
from railgate.position_link.spec import Config

__all__ = ["Plant"]


class Plant(wiring.Component):
    """Position system, a line each of UEF and DATA, and radio unit.

    clk, anf, radio_valid, radio_data: in, 1 bit, the link's outputs. uef, data: out, 1 bit, the
    link's inputs. system: what the position system does, see PositionSystem. line.uef, line.data:
    a DISTURBANCE each. radio: what the radio unit has received, see RadioUnit.
    """

    def __init__(self, config: Config) -> None:
        self._system, self._radio = PositionSystem(config), RadioUnit(config)
        lines = wiring.Signature({"uef": Out(DISTURBANCE), "data": Out(DISTURBANCE)})
        super().__init__(
            {
                "clk": In(1),
                "anf": In(1),
                "radio_valid": In(1),
                "radio_data": In(1),
                "uef": Out(1),
                "data": Out(1),
                "system": Out(self._system.behaviour.signature),
                "line": Out(lines),
                "radio": Out(self._radio.received.signature),
            }
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.submodules.system = system = self._system
        m.submodules.radio = radio = self._radio
        m.d.comb += [
            system.clk.eq(self.clk),
            system.anf.eq(self.anf),
            radio.clk.eq(self.clk),
            radio.valid.eq(self.radio_valid),
            radio.data.eq(self.radio_data),
        ]
        for name in ("uef", "data"):
            m.submodules[f"line_{name}"] = line = Line()
            m.d.comb += [line.source.eq(getattr(system, name)), getattr(self, name).eq(line.pin)]
            wiring.connect(m, wiring.flipped(getattr(self.line, name)), line.disturbance)
        wiring.connect(m, wiring.flipped(self.system), system.behaviour)
        wiring.connect(m, wiring.flipped(self.radio), radio.received)
        return m
