"""Wide sums in chunks: no carry goes through more than one of them in a tick."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["ChunkedSum", "LookaheadCounter"]

CHUNK_BITS = 8


class LookaheadCounter(wiring.Component):
    """Counts steps, modulo its width.

    step: in, 1 bit. clear: in, 1 bit, back to 0. Between any two of these are 2 ticks or more, but
    where both come together, which is a clear. value: out, register of `width` bits.

    What a step carries is looked ahead in registers: `full` tells which chunks of the value are
    all ones, and `carries`, a tick behind it, into which chunks a step carries.
    """

    def __init__(self, width: int) -> None:
        self._width = width
        super().__init__({"step": In(1), "clear": In(1), "value": Out(width)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        chunks = [self.value[part] for part in _chunks(self._width)]
        full = Signal(len(chunks))
        carries = Signal(len(chunks), init=1)
        m.d.sync += [
            full.eq(Cat(chunk.all() for chunk in chunks)),
            carries.eq(Cat(full[:n].all() for n in range(len(chunks)))),
        ]
        with m.If(self.clear):
            m.d.sync += self.value.eq(0)
        with m.Elif(self.step):
            m.d.sync += [chunk.eq(chunk + carries[n]) for n, chunk in enumerate(chunks)]
        return m


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
        parts = _chunks(self._width)
        carries = Signal(len(parts), init=self._carries_at_start(parts))
        for n, part in enumerate(parts):
            addend = (self._addend & (1 << part.stop) - 1) >> part.start
            below = carries[n - 1] if n else 0
            m.d.sync += Cat(self.total[part], carries[n]).eq(self.value[part] + addend + below)
        m.d.comb += self.overflow.eq(carries[-1] | (self._addend >> self._width != 0))
        return m

    def _carries_at_start(self, parts: list[slice]) -> int:
        found = 0
        for n, part in enumerate(parts):
            modulus = 1 << part.stop
            found |= (self._start % modulus + self._addend % modulus) // modulus << n
        return found


def _chunks(width: int) -> list[slice]:
    """The bits of each chunk, the lowest first."""
    return [slice(at, min(at + CHUNK_BITS, width)) for at in range(0, width, CHUNK_BITS)]
