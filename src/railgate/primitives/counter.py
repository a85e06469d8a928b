"""Wide sums in chunks: no carry goes through more than one of them in a tick."""

from __future__ import annotations

from collections.abc import Mapping

from amaranth.hdl import Cat, Const, Module, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.primitives.chunked import chunks, packed

__all__ = ["ChunkedSum", "LookaheadCounter"]

CHUNK_BITS = 4


class LookaheadCounter(wiring.Component):
    """Counts steps, any two of them at least 3 ticks apart, modulo `modulus`.

    step: in, 1 bit. value: out, register of `width` bits. One out of the name of each mark, 1 bit,
    register: 2 ticks ago the value was this number, which is below the modulus.

    What a step does is looked ahead, in the same time: the register `full` tells which chunks of
    the value were all ones a tick ago, `carries` into which of them a step would have carried a
    tick before, and `last` whether it would have led to 0.
    """

    def __init__(self, modulus: int, marks: Mapping[str, int] | None = None) -> None:
        self._modulus = modulus
        self._width = (modulus - 1).bit_length()
        self._marks = marks or {}
        super().__init__(
            {"step": In(1), "value": Out(self._width)}
            | {name: Out(1, init=number == 0) for name, number in self._marks.items()}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        pieces = [self.value[part] for part in chunks(self._width, CHUNK_BITS)]
        for name, number in self._marks.items():
            m.d.sync += getattr(self, name).eq(self._at(m, number, name))
        wraps = self._modulus < 1 << self._width  # other than by itself
        ends = self._at(m, self._modulus - 1, "last") if wraps else Const(0)

        full = Signal(len(pieces))
        carries = Signal(len(pieces), init=1)
        last = Signal()
        m.d.sync += [full.eq(Cat(piece.all() for piece in pieces)), last.eq(ends)]
        for n, (chunk, greatest) in enumerate(
            zip(pieces, _split(self._modulus - 1, self._width), strict=True)
        ):
            # What leads from its greatest value to 0; the carry is the lowest bit of it.
            lacks = -greatest if wraps else 0
            carry = full[:n].all()
            m.d.sync += carries[n].eq((carry | ends) if lacks & 1 else (carry & ~ends))
            addend = carries[n] | (last.replicate(len(chunk)) & (lacks & ~1))
            with m.If(self.step):
                m.d.sync += chunk.eq(chunk + addend)
        return m

    def _at(self, m: Module, number: int, name: str) -> Value:
        """A tick ago the value was this number."""
        parts = _split(number, self._width)
        pieces = [self.value[part] for part in chunks(self._width, CHUNK_BITS)]
        at = Signal(len(parts), name=f"at_{name}", init=packed(part == 0 for part in parts))
        m.d.sync += at.eq(Cat(piece == part for piece, part in zip(pieces, parts, strict=True)))
        return at.all()


class ChunkedSum(wiring.Component):
    """A value plus a constant.

    value: in, `width` bits, `start` at start. total: out, `width` bits, register, the sum modulo
    its width. overflow: out, 1 bit, the sum is more. They are right from the start on, and when
    the value has changed, after as many ticks as it has chunks.

    Its register `carries` tells, bit n, what chunk n carries into the next.
    """

    def __init__(self, width: int, addend: int, start: int = 0) -> None:
        self._width = width
        self._addend = addend
        self._start = start
        total = (start + addend) % (1 << width)
        super().__init__({"value": In(width), "total": Out(width, init=total), "overflow": Out(1)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        parts = chunks(self._width, CHUNK_BITS)
        tops = [1 << part.stop for part in parts]
        carried = packed(self._start % top + self._addend % top >= top for top in tops)
        carries = Signal(len(parts), init=carried)
        for n, (part, addend) in enumerate(
            zip(parts, _split(self._addend, self._width), strict=True)
        ):
            below = carries[n - 1] if n else 0
            m.d.sync += Cat(self.total[part], carries[n]).eq(self.value[part] + addend + below)
        m.d.comb += self.overflow.eq(carries[-1] | (self._addend >> self._width != 0))
        return m


def _split(number: int, width: int) -> list[int]:
    """The chunks of a number, of its lowest `width` bits."""
    return [number % (1 << part.stop) >> part.start for part in chunks(width, CHUNK_BITS)]
