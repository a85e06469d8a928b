"""One disturbed wire."""

from __future__ import annotations

from amaranth.hdl import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["DISTURBANCE", "Line"]

DISTURBANCE = wiring.Signature({"flip": In(1), "low": In(1), "high": In(1)})
"""flip: inverts. low, high: hold the level, high before low."""


class Line(wiring.Component):
    """A wire from `source` to `pin`, both 1 bit, with a DISTURBANCE; no tick passes."""

    def __init__(self) -> None:
        super().__init__({"source": In(1), "disturbance": Out(DISTURBANCE), "pin": Out(1)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        by = self.disturbance
        m.d.comb += self.pin.eq((self.source ^ by.flip) & ~by.low | by.high)
        return m
