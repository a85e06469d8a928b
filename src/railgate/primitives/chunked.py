"""Counters and sums cut into chunks by registers, so that no carry runs through more than one.

A counter's chunks are told ahead of time that the carry will pass them: its value is exact in
every tick. A sum's chunks are *skewed*: chunk j is, j ticks later, what an adder in one piece has.
"""

from __future__ import annotations

from itertools import pairwise

from amaranth.hdl import Cat, Const, Module, Mux, Signal, Value, ValueLike

__all__ = ["CHUNK_BITS", "accumulate", "chunks", "count", "delayed", "exceeds", "masked", "skewed"]

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


def count(
    m: Module, value: Signal, up: ValueLike = 1, *, restart: ValueLike = 0, saturates: bool = False
) -> Signal:
    """Makes a register a counter: in each tick value' = restart ? its init : value + up.

    up, restart: 1 bit. saturates: it stays all ones, else wraps. Returns a
    register of 1 bit: it is all ones, exact in every tick.

    The low chunk counts. The next ones change only as it wraps, so that there is time to find out
    whether the carry will pass them: `ahead` tells of each whether it and all below it, the low
    one aside, are all ones, as late as it is high; `wraps` tells of the low one, exactly.
    """
    low, *high = (value[part] for part in chunks(len(value)))
    wraps = Signal(name=f"{value.name}_wraps")
    ahead = Signal(len(high), name=f"{value.name}_ahead")
    full = Signal(name=f"{value.name}_full")
    passes = [Value.cast(1), *ahead]
    go = up & ~full if saturates else up
    with m.If(go):
        m.d.sync += low.eq(low + 1)
    for here, chunk in zip(passes, high, strict=False):
        with m.If(go & wraps & here):
            m.d.sync += chunk.eq(chunk + 1)
    ones = Cat(low[0] ^ up, low[1:]).all()
    m.d.sync += [
        wraps.eq((full if saturates else 0) | ones),
        full.eq((full if saturates else 0) | (ones & passes[-1])),
        ahead.eq(Cat(here & chunk.all() for here, chunk in zip(passes, high, strict=False))),
    ]
    with m.If(restart):
        m.d.sync += [register.eq(register.init) for register in (value, wraps, ahead, full)]
    return full


def exceeds(m: Module, value: Signal, limit: int, *, restart: ValueLike) -> Signal:
    """Register: whether a counter that goes up in each tick, from `restart` on, is > limit.

    limit: at least 2 above where it restarts. It stays 1 until `restart`, also where it wraps.
    """
    near = Signal(len(chunks(len(value))), name=f"{value.name}_near_{limit}")
    over = Signal(name=f"{value.name}_over_{limit}")
    with m.If(restart):
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


def masked(m: Module, value: Value, by: ValueLike, name: str = "masked") -> Value:
    """The skewed value of the tick before where `by` was 1, else 0; skewed."""
    taken = Signal(len(value), name=name)
    for late, part in enumerate(chunks(len(value))):
        m.d.sync += taken[part].eq(Mux(by, value[part], 0))
        by = delayed(m, by, 1, name=f"{name}_by_{late}")
    return taken


def accumulate(m: Module, total: Signal, addend: Value, *, restart: ValueLike = 0) -> None:
    """Makes a register a sum: in each tick total' = restart ? its init : total + addend, skewed.

    addend: skewed, at most as wide. restart: 1 bit, in the tick of the low chunk.
    """
    start = Const(total.init, len(total))
    carry: ValueLike = 0
    for late, part in enumerate(chunks(len(total))):
        chunk, to = total[part], Signal(name=f"{total.name}_carry_{late}")
        more = Cat(1, chunk) + Cat(carry, addend[part])
        m.d.sync += Cat(chunk, to).eq(more[1:])
        with m.If(restart):
            m.d.sync += [chunk.eq(start[part]), to.eq(0)]
        carry, restart = to, delayed(m, restart, 1, name=f"{total.name}_restart_{late}")
