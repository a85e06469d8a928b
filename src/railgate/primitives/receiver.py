"""A bit-timed receiver of messages that begin with a start bit."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["SerialReceiver"]


class SerialReceiver(wiring.Component):
    """Reads messages of `bits` ≥ 2 bits, the first one a 0, from a line that rests at 1.

    While none is received, a fall in tick F begins one: bit j = 0, 1, … is sampled in tick
    F + j · bit_ticks + ⌊bit_ticks / 2⌋, bit_ticks ≥ 2. Is the start bit, j = 0, a 1, it was none,
    and another may begin from the next tick on; else in the tick `done` after the last sample.

    level, fall: in, 1 bit, of the line, filtered. All outs that follow but `word` last one tick.
    starts, false_start: out, 1 bit, the start bit is sampled, and it is a 0, or a 1. bit: out, 1
    bit, one of the other bits is sampled; data: out, 1 bit, in such a tick its value. done: out, 1
    bit, register. word: out, register of `bits` - 1 bits, those after the start bit, the first one
    the most significant, whole with `done` and until the next message's first is sampled.
    """

    def __init__(self, bit_ticks: int, bits: int) -> None:
        self._bit_ticks = bit_ticks
        self._bits = bits
        outs = ("bit", "data", "starts", "done", "false_start")
        super().__init__(
            {"level": In(1), "fall": In(1), "word": Out(bits - 1)} | {name: Out(1) for name in outs}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        receives = Signal()
        first = Signal()  # the bit sampled next is the start bit
        last = Signal()
        until_sample = Signal(range(self._bit_ticks))
        remaining = Signal(range(self._bits))  # bits after the one sampled next

        sample = Signal()
        m.d.comb += [
            sample.eq(receives & (until_sample == 0)),
            last.eq(remaining == 0),
            self.starts.eq(sample & first & ~self.level),
            self.false_start.eq(sample & first & self.level),
            self.bit.eq(sample & ~first),
            self.data.eq(self.level),
        ]
        m.d.sync += [until_sample.eq(until_sample - 1), self.done.eq(sample & last)]
        with m.If(self.bit):
            m.d.sync += self.word.eq(Cat(self.data, self.word))
        with m.If(sample):
            m.d.sync += [
                first.eq(0),
                until_sample.eq(self._bit_ticks - 1),
                remaining.eq(remaining - 1),
            ]
        with m.If(self.false_start | (sample & last)):
            m.d.sync += receives.eq(0)
        with m.If(~receives & self.fall):
            m.d.sync += [
                receives.eq(1),
                first.eq(1),
                until_sample.eq(self._bit_ticks // 2 - 1),
                remaining.eq(self._bits - 1),
            ]
        return m
