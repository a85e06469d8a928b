"""What the functions are placed beside: the practical ceiling of a part, and plain peers.

None of them is part of a function. Each is written down from its public description, in the form
in which it is found in text books, without diagnosis.
"""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.crc.catalog import CRC32_ETHERNET
from amaranth.lib.wiring import In, Out

__all__ = ["Counter", "Crc32", "Lfsr", "Ssi"]


class Lfsr(wiring.Component):
    """32 registers in a Galois ring, x³² + x²² + x² + x + 1: one gate between two of them at most.

    state: out, 32 bits. What it reaches, no design of the same flow will exceed by much.
    """

    def __init__(self) -> None:
        super().__init__({"state": Out(32, init=1)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.d.sync += self.state.eq((self.state >> 1) ^ Mux(self.state[0], 0x8020_0003, 0))
        return m


class Counter(wiring.Component):
    """A quadrature decoder that counts steps and measures the last period of a, beside `Odometer`.

    a, b, strobe: in, 1 bit. position, period: out, 32 bits, latched by the strobe.
    """

    def __init__(self) -> None:
        super().__init__(
            {"a": In(1), "b": In(1), "strobe": In(1), "position": Out(32), "period": Out(32)}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        a, b = Signal(3), Signal(3)
        steps, since, last = Signal(32), Signal(32), Signal(32)
        m.d.sync += [a.eq(Cat(self.a, a)), b.eq(Cat(self.b, b)), since.eq(since + 1)]
        with m.If(a[1] ^ a[2] ^ b[1] ^ b[2]):
            m.d.sync += steps.eq(Mux(a[1] ^ b[2], steps + 1, steps - 1))
        with m.If(a[1] & ~a[2]):
            m.d.sync += [last.eq(since), since.eq(1)]
        with m.If(self.strobe):
            m.d.sync += [self.position.eq(steps), self.period.eq(last)]
        return m


class Ssi(wiring.Component):
    """A reader of a synchronous serial interface, as of absolute encoders, beside `PositionLink`.

    start, data: in, 1 bit. clock: out, 1 bit, 1 at rest. word: out, 25 bits. done: out, 1 bit.
    """

    def __init__(self) -> None:
        super().__init__(
            {
                "start": In(1),
                "data": In(1),
                "clock": Out(1, init=1),
                "word": Out(25),
                "done": Out(1),
            }
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        data, wait, left = Signal(2), Signal(range(20)), Signal(range(26))
        m.d.sync += [data.eq(Cat(self.data, data)), wait.eq(wait - 1), self.done.eq(0)]
        with m.If(left == 0):
            m.d.sync += [wait.eq(19), left.eq(Mux(self.start, 25, 0))]
        with m.Elif(wait == 0):
            m.d.sync += [wait.eq(19), self.clock.eq(~self.clock)]
            with m.If(~self.clock):
                m.d.sync += [self.word.eq(Cat(data[1], self.word)), left.eq(left - 1)]
                m.d.sync += self.done.eq(left == 1)
        return m


class Crc32(wiring.Component):
    """Ethernet's CRC of a byte a tick, Amaranth's own, beside `Channel`.

    start, valid: in, 1 bit. byte: in, 8 bits. crc: out, 32 bits.
    """

    def __init__(self) -> None:
        super().__init__({"start": In(1), "valid": In(1), "byte": In(8), "crc": Out(32)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.submodules.processor = processor = CRC32_ETHERNET(8).create()
        m.d.comb += [
            processor.start.eq(self.start),
            processor.valid.eq(self.valid),
            processor.data.eq(self.byte),
            self.crc.eq(processor.crc),
        ]
        return m
