"""An asynchronous input made fit for counting: synchroniser, then glitch filter."""

from __future__ import annotations

from amaranth.hdl import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.wiring import In, Out

__all__ = ["FilteredInput"]

STAGES = 2


class FilteredInput(wiring.Component):
    """Passes a level that held for more than `filter_ticks`, both edges `3 + filter_ticks` late.

    The level at start counts as no edge: until it has come through, in tick 3, the output is 0,
    and neither edges nor glitches are told before tick 4.

    pin: in, 1 bit, asynchronous. level: out, 1 bit, filtered. rise, fall: out, 1 bit, in the tick
    in which `level` is new. glitch: out, 1 bit, in the tick in which a level that was held for at
    most `filter_ticks` has gone. Requirement ODO-9.
    """

    def __init__(self, filter_ticks: int) -> None:
        self._filter_ticks = filter_ticks
        super().__init__(
            {"pin": In(1), "level": Out(1), "rise": Out(1), "fall": Out(1), "glitch": Out(1)}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        synchronised = Signal()
        m.submodules.synchroniser = FFSynchronizer(
            self.pin, synchronised, reset_less=False, stages=STAGES
        )

        # Seats the level when the pin's first one leaves the synchroniser, then tells edges.
        age = Signal(range(STAGES + 3))
        with m.If(age != STAGES + 2):
            m.d.sync += age.eq(age + 1)

        held = Signal(range(self._filter_ticks + 1))
        previous = Signal()
        m.d.sync += [previous.eq(self.level), held.eq(0)]
        with m.If(age == STAGES):
            m.d.sync += self.level.eq(synchronised)
        with m.Elif((age > STAGES) & (synchronised != self.level)):
            with m.If(held == self._filter_ticks):
                m.d.sync += self.level.eq(synchronised)
            with m.Else():
                m.d.sync += held.eq(held + 1)

        edge = (age == STAGES + 2) & (self.level != previous)
        m.d.comb += [
            self.rise.eq(edge & self.level),
            self.fall.eq(edge & ~self.level),
            self.glitch.eq((held != 0) & (synchronised == self.level)),
        ]
        return m
