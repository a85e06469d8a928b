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

    pin: in, 1 bit, asynchronous. level: out, 1 bit, register, filtered. rise, fall: out, 1 bit,
    registers, in the tick in which `level` is new. glitch: out, 1 bit, in the tick in which a level
    that was held for at most `filter_ticks` has gone. Requirement ODO-9.
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

        seats = Signal(STAGES + 1, init=1)  # the last bit: the pin's first level is synchronised
        held = Signal(range(self._filter_ticks + 1))  # for so long before this tick
        full = Signal(init=self._filter_ticks == 0)  # the other level passes
        other = synchronised != self.level
        counts = other & ~full
        passes = Signal()
        m.d.comb += passes.eq(other & full)
        m.d.sync += [
            seats.eq(seats << 1),
            held.eq((held + 1) & counts.replicate(len(held))),
            self.rise.eq(passes & synchronised & ~seats[-1]),
            self.fall.eq(passes & ~synchronised & ~seats[-1]),
        ]
        if self._filter_ticks:
            m.d.sync += full.eq(seats[-2] | (counts & (held == self._filter_ticks - 1)))
        with m.If(passes):
            m.d.sync += self.level.eq(synchronised)
        m.d.comb += self.glitch.eq((held != 0) & (synchronised == self.level))
        return m
