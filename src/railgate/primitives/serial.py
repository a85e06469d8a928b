"""Serial lines: the check that goes along with the bits, and the transmitter."""

from __future__ import annotations

from amaranth.hdl import Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["SerialCheck", "SerialTransmitter"]


class SerialCheck(wiring.Component):
    """A CRC, or with a width of 1 a parity, bit by bit.

    Its register starts as `initial`; each bit shifts it left and, if the bit shifted out differs
    from the bit, adds `polynomial`, which is written without its leading term.

    restart: in, 1 bit, the register starts anew before this tick's bit. enable: in, 1 bit, there
    is a bit in this tick. bit: in, 1 bit. field: out, `width` bits, the register after the tick
    before, xor `final`.
    """

    def __init__(self, width: int, polynomial: int, initial: int, final: int) -> None:
        self._polynomial = polynomial
        self._initial = initial
        self._final = final
        super().__init__({"restart": In(1), "enable": In(1), "bit": In(1), "field": Out(width)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        register = Signal.like(self.field, init=self._initial)
        now = Mux(self.restart, self._initial, register)
        shifted = Signal.like(self.field)
        m.d.comb += [
            shifted.eq(now << 1),
            self.field.eq(register ^ self._final),
        ]
        with m.If(self.enable):
            adds = now[-1] ^ self.bit
            m.d.sync += register.eq(shifted ^ Mux(adds, self._polynomial, 0))
        with m.Elif(self.restart):
            m.d.sync += register.eq(self._initial)
        return m


class SerialTransmitter(wiring.Component):
    """Sends a frame, then a tail, the most significant bit first, one bit with each strobe.

    strobe: in, 1 bit, in the tick before a bit begins. start: in, 1 bit, in a strobe's tick: with
    it begins the frame's first bit. frame: in, `width` bits, read with the start. tail: in,
    `tail_width` bits, read with the strobe of its own first bit; only where tail_width > 0.
    valid, data: out, 1 bit each, registers: a bit is sent, and which; 0 where none is.
    bit: out, 1 bit, the one that begins with a strobe now.
    """

    def __init__(self, width: int, tail_width: int = 0) -> None:
        self._width = width
        self._tail_width = tail_width
        super().__init__(
            {
                "strobe": In(1),
                "start": In(1),
                "frame": In(width),
                "valid": Out(1),
                "data": Out(1),
                "bit": Out(1),
            }
            | ({"tail": In(tail_width)} if tail_width else {})
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        size = max(self._width, self._tail_width)
        whole = self._width + self._tail_width
        more = Signal()  # bits follow the one that is sent
        remaining = Signal(range(whole), init=whole - 1, reset_less=True)  # with `more`: so many
        rest = Signal(size)

        bits = Signal(size)
        m.d.comb += [bits.eq(rest), self.bit.eq(bits[-1])]
        with m.If(self.start):
            m.d.comb += bits.eq(_aligned(self.frame, size))
        if self._tail_width:
            tail_next = Signal()  # remaining is tail_width
            with m.Elif(tail_next):
                m.d.comb += bits.eq(_aligned(self.tail, size))

        with m.If(self.strobe):
            m.d.sync += [
                self.valid.eq(self.start | more),
                self.data.eq((self.start | more) & self.bit),
                rest.eq(bits << 1),
                remaining.eq(remaining - 1),
                more.eq(more & (remaining != 1)),
            ]
            if self._tail_width:
                m.d.sync += tail_next.eq(remaining == self._tail_width + 1)
        with m.If(self.start):
            m.d.sync += [remaining.eq(whole - 1), more.eq(whole > 1)]
            if self._tail_width:
                m.d.sync += tail_next.eq(self._width == 1)
        return m


def _aligned(bits: Value, size: int) -> Value:
    """The bits at the top of `size`."""
    return bits << size - len(bits)
