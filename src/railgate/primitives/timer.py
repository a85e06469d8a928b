"""A timer for the ticks that follow an event."""

from __future__ import annotations

from amaranth.hdl import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["OneShot"]


class OneShot(wiring.Component):
    """Runs for the `ticks` ≥ 1 ticks after a trigger, each trigger anew.

    trigger: in, 1 bit. remaining: out, register, how many of these ticks are left with this one:
    `ticks` in the tick after the trigger, then one less each, 0 where none is. active: out, 1 bit,
    register, it is not 0.
    """

    def __init__(self, ticks: int) -> None:
        self._ticks = ticks
        super().__init__({"trigger": In(1), "remaining": Out(range(ticks + 1)), "active": Out(1)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        with m.If(self.trigger):
            m.d.sync += [self.remaining.eq(self._ticks), self.active.eq(1)]
        with m.Elif(self.active):
            m.d.sync += [
                self.remaining.eq(self.remaining - 1),
                self.active.eq(self.remaining != 1),
            ]
        return m
