"""Wires that can be disturbed: the cross-link and the feedback."""

from __future__ import annotations

from amaranth.hdl import Module, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["DISTURBANCE", "Line", "held"]

DISTURBANCE = wiring.Signature({"flip": In(1), "low": In(1), "high": In(1)})
"""flip: inverts. low, high: hold the level, high before low."""


def held(source: Value, low: Value, high: Value) -> Value:
    """The source's bits, 0 where `low` holds them, 1 where `high` does, high before low."""
    return source & ~low | high


class Line(wiring.Component):
    """One direction of the cross-link, from `source` to `pin`, both 1 bit, with a DISTURBANCE.

    delay_ticks: flip-flops of the sender's domain, which start at 1.
    """

    def __init__(self, delay_ticks: int) -> None:
        self._delay_ticks = delay_ticks
        super().__init__({"source": In(1), "disturbance": Out(DISTURBANCE), "pin": Out(1)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        sent = self.source
        for tick in range(self._delay_ticks):
            later = Signal(init=1, name=f"later_{tick}")
            m.d.sync += later.eq(sent)
            sent = later
        by = self.disturbance
        m.d.comb += self.pin.eq(held(sent ^ by.flip, by.low, by.high))
        return m
