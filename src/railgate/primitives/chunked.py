"""Counters and sums cut into chunks by registers, so that no carry runs through more than one.

A counter's chunks are told ahead of time that the carry will pass them: its value is exact in
every tick. A sum's chunks are *skewed*: chunk j is, j ticks later, what an adder in one piece has.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

from amaranth.hdl import Cat, Module, Mux, Signal, Value, ValueLike

__all__ = ["CHUNK_BITS", "Count", "accumulate", "chunks", "count", "delayed", "exceeds", "skewed", "state_bits"]

CHUNK_BITS = 10


def chunks(width: int) -> list[slice]:
    """The bits of each chunk of a register of that width, from the least significant one up."""
    ends = [*range(0, width, CHUNK_BITS), width]
    return [slice(*ends) for ends in pairwise(ends)]


def delayed(
    m: Module, value: ValueLike, ticks: int, *, init: int = 0, name: str = "delayed"
) -> Value:
    """What the value was so many ticks ago; `init` in the first ones."""
    value = Value.cast(value)
    for tick in range(ticks):
        register = Signal(value.shape(), init=init, name=f"{name}_{tick}")
        m.d.sync += register.eq(value)
        value = register
    return value


@dataclass(frozen=True)
class Count:
    """The registers of a counter. full: it is all ones, exact in every tick."""

    value: Signal
    wraps: Signal
    ahead: Signal
    full: Signal

    @property
    def state(self) -> Value:
        """All of them: assigned to another one's, it becomes its copy."""
        return Cat(self.value, self.wraps, self.ahead, self.full)


def state_bits(width: int) -> int:
    """How many bits the state of a counter of that width has."""
    return width + len(chunks(width)) + 1


def count(
    m: Module, value: Signal, up: ValueLike = 1, *, clear: ValueLike = 0, saturates: bool = False
) -> Count:
    """Makes a register a counter: in each tick value' = (clear ? 0 : value) + up.

    value: at least 2 bits. up, clear: 1 bit. saturates: it stays all ones, else wraps.

    The low chunk counts. The next ones change only as it wraps, so that there is time to find out
    whether the carry will pass them: `ahead` tells of each whether it and all below it, the low
    one aside, are all ones, as late as it is high; `wraps` tells of the low one, exactly.
    """
    low, *high = (value[part] for part in chunks(len(value)))
    of = Count(
        value,
        Signal(name=f"{value.name}_wraps"),
        Signal(len(high), name=f"{value.name}_ahead"),
        Signal(name=f"{value.name}_full"),
    )
    go = up & ~of.full if saturates else up
    passes = [Value.cast(1), *of.ahead]
    with m.If(clear):
        m.d.sync += [register.eq(0) for register in (*high, of.wraps, of.ahead, of.full)]
        m.d.sync += low.eq(up)
    with m.Else():
        ones = low[1:].all() & (low[0] ^ go)
        m.d.sync += [
            low.eq(low + go),
            of.wraps.eq(ones),
            of.ahead.eq(Cat(here & chunk.all() for here, chunk in zip(passes, high, strict=False))),
            of.full.eq(ones & passes[-1]),
        ]
        for here, chunk in zip(passes, high, strict=False):
            with m.If(go & of.wraps & here):
                m.d.sync += chunk.eq(chunk + 1)
    return of


def exceeds(m: Module, value: Signal, limit: int, *, clear: ValueLike) -> Signal:
    """Register: whether a counter that goes up in each tick, and to 1 after `clear`, is > limit.

    limit: at least 3. It stays 1 until `clear`, also where the counter wraps.
    """
    near = Signal(len(chunks(len(value))), name=f"{value.name}_near_{limit}")
    over = Signal(name=f"{value.name}_over_{limit}")
    with m.If(clear):
        m.d.sync += [near.eq(0), over.eq(0)]
    with m.Else():
        same = [
            value[part] == (limit - 1 >> part.start) % (1 << part.stop - part.start)
            for part in chunks(len(value))
        ]
        m.d.sync += [near.eq(Cat(same)), over.eq(over | near.all())]
    return over


def skewed(m: Module, value: Value, name: str = "skewed") -> Value:
    """The value, each chunk of it a tick later than the one below."""
    return Cat(
        delayed(m, value[part], late, name=f"{name}_{late}")
        for late, part in enumerate(chunks(len(value)))
    )


def accumulate(
    m: Module, total: Signal, addend: Value, *, fresh: ValueLike = 0, enable: ValueLike = 1
) -> None:
    """Makes a register a sum: with `enable` total' = (fresh ? 0 : total) + addend, all skewed.

    addend: skewed, at most as wide. fresh, enable: 1 bit, in the tick of the low chunk.
    """
    carry: ValueLike = 0
    for late, part in enumerate(chunks(len(total))):
        chunk, to = total[part], Signal(name=f"{total.name}_carry_{late}")
        more = Cat(1, Mux(fresh, 0, chunk)) + Cat(carry, addend[part])
        with m.If(enable):
            m.d.sync += Cat(chunk, to).eq(more[1:])
        with m.Else():
            m.d.sync += to.eq(0)
        carry = to
        fresh = delayed(m, fresh, 1, name=f"{total.name}_fresh_{late}")
        enable = delayed(m, enable, 1, name=f"{total.name}_enable_{late}")
