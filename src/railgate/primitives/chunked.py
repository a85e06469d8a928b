"""Counters and sums cut into chunks by registers, so that no carry runs through more than one.

A counter's chunks are told ahead of time that the carry will pass them: its value is exact in
every tick. A sum's chunks are *skewed*: chunk j is, PACE · j ticks later, what an adder in one
piece has.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise

from amaranth.hdl import Cat, Const, Module, Mux, Signal, Value, ValueLike

__all__ = [
    "CHUNK_BITS",
    "PACE",
    "accumulate",
    "chunks",
    "count",
    "delayed",
    "exceeds",
    "masked",
    "packed",
    "skewed",
]

CHUNK_BITS = 12
PACE = 2
"""Ticks by which each chunk of a sum is later than the one below."""
LOW_BITS = 3
"""Of a counter: while they go through all their values, its other chunks are looked through."""
LUT_BITS = 4
"""Of what is compared in a tick."""


def chunks(width: int, bits: int = CHUNK_BITS) -> list[slice]:
    """The bits of each chunk of a register of that width, from the least significant one up."""
    ends = [*range(0, width, bits), width]
    return [slice(*ends) for ends in pairwise(ends)]


def packed(bits: Iterable[bool]) -> int:
    """The number of these bits, from the least significant one up."""
    return sum(bit << at for at, bit in enumerate(bits))


def delayed(
    m: Module,
    value: ValueLike,
    ticks: int,
    *,
    init: int = 0,
    reset_less: bool = False,
    name: str = "delayed",
) -> Value:
    """What the value was so many ticks ago; `init` in the first ones, unless it is reset_less."""
    value = Value.cast(value)
    for tick in range(ticks):
        register = Signal(value.shape(), init=init, reset_less=reset_less, name=f"{name}_{tick}")
        m.d.sync += register.eq(value)
        value = register
    return value


def count(
    m: Module, value: Signal, up: ValueLike = 1, *, restart: ValueLike = 0, saturates: bool = False
) -> Signal:
    """Makes a register a counter: in each tick value' = restart ? its init : value + up.

    value: may be reset_less where `restart` is 1 in the first tick. up, restart: 1 bit. saturates:
    it stays all ones, else wraps. Returns a register of 1 bit: it is all ones, exact in every tick.

    The low bits count. The chunks above change only as these wrap, so that there is time to find
    out whether the carry will pass them: `ones` tells of each few bits, late, whether they are all
    ones; `ahead` of each chunk whether it and all below it, the low bits aside, are so, the later
    the higher it is; `passes`, exactly, whether the next one up passes through all below it.
    """
    low, high = value[:LOW_BITS], value[LOW_BITS:]
    above = chunks(len(high))
    few = chunks(len(high), LUT_BITS)
    start = value.init % (1 << len(value))

    def flags(name: str, init: Iterable[bool]) -> Signal:
        bits = list(init)
        return Signal(
            len(bits), init=packed(bits), reset_less=value.reset_less, name=f"{value.name}_{name}"
        )

    def only_ones(value: int, bits: slice) -> bool:
        return value >> bits.start | -1 << bits.stop - bits.start == -1

    whole = only_ones(start, slice(0, len(value)))
    ones = flags("ones", (only_ones(start >> LOW_BITS, each) for each in few))
    ahead = flags("ahead", (only_ones(start >> LOW_BITS, slice(0, at.stop)) for at in above))
    passes = flags(
        "passes",
        (
            only_ones(start, slice(0, LOW_BITS + at.start)) and not (saturates and whole)
            for at in above
        ),
    )
    full = flags("full", [whole])
    stays = Const(saturates, 1)
    with m.If(up & ~(full & stays)):
        m.d.sync += low.eq(low + 1)
    for carry, at in zip(passes, above, strict=True):
        with m.If(up & carry):
            m.d.sync += high[at].eq(high[at] + 1)
    wraps = Cat(low[0] ^ up, low[1:]).all()
    below = Cat(1, ahead)
    parts = chunks(len(ones), CHUNK_BITS // LUT_BITS)
    m.d.sync += [
        passes.eq(Cat(wraps & here & ~(below[-1] & stays) for here in below[:-1])),
        full.eq((wraps & below[-1]) | (full & stays)),
        ones.eq(Cat(_same(high, -1))),
        ahead.eq(Cat(ones[part].all() & here for part, here in zip(parts, below, strict=False))),
    ]
    with m.If(restart):
        m.d.sync += [register.eq(register.init) for register in (value, ones, ahead, passes, full)]
    return full


def exceeds(m: Module, value: Signal, limit: int, *, restart: ValueLike) -> Signal:
    """Register: whether a counter that goes up in each tick, from `restart` on, is > limit.

    limit: at least 2 above where it restarts. restart: 1 bit, 1 in the first tick. It stays 1 until
    `restart`, also where the counter wraps.
    """
    same = Cat(_same(value, limit - 1))
    near = Signal(len(same), reset_less=True, name=f"{value.name}_near_{limit}")
    over = Signal(reset_less=True, name=f"{value.name}_over_{limit}")
    m.d.sync += [near.eq(same), over.eq(over | near.all())]
    with m.If(restart):
        m.d.sync += [near.eq(0), over.eq(0)]
    return over


def _same(value: Value, to: int) -> list[Value]:
    """Of each few bits of the value, from the least significant ones up, whether they are `to`."""
    same = Const(to % (1 << len(value)), len(value))
    return [value[part] == same[part] for part in chunks(len(value), LUT_BITS)]


def skewed(
    m: Module,
    value: Value,
    bits: int = CHUNK_BITS,
    *,
    reset_less: bool = False,
    name: str = "skewed",
) -> Value:
    """The value, each chunk of it PACE ticks later than the one below."""
    return Cat(
        delayed(m, value[part], PACE * late, reset_less=reset_less, name=f"{name}_{late}")
        for late, part in enumerate(chunks(len(value), bits))
    )


def masked(
    m: Module, value: Value, by: ValueLike, bits: int = CHUNK_BITS, *, name: str = "masked"
) -> Value:
    """The skewed value of the tick before where `by` was 1 in the tick before that, else 0."""
    taken = Signal(len(value), reset_less=True, name=name)
    for late, part in enumerate(chunks(len(value), bits)):
        drops = Signal(init=1, name=f"{name}_drops_{late}")
        m.d.sync += [drops.eq(~by), taken[part].eq(Mux(drops, 0, value[part]))]
        by = delayed(m, ~drops, PACE - 1, name=f"{name}_by_{late}")
    return taken


def accumulate(
    m: Module,
    total: Signal,
    addend: Value,
    bits: int = CHUNK_BITS,
    *,
    restart: ValueLike = 0,
) -> None:
    """Makes a register a sum: in each tick total' = restart ? its init : total + addend, skewed.

    total: may be reset_less where `restart` is 1 in the first tick; as may then what makes up the
    addend. addend: skewed, at most as wide. restart: 1 bit, in the tick of the low chunk.
    """
    start = Const(total.init, len(total))
    carry: ValueLike = 0
    for late, part in enumerate(chunks(len(total), bits)):
        chunk = total[part]
        to = Signal(name=f"{total.name}_carry_{late}", reset_less=total.reset_less)
        more = Cat(1, chunk) + Cat(carry, addend[part])
        m.d.sync += Cat(chunk, to).eq(more[1:])
        with m.If(restart):
            m.d.sync += [chunk.eq(start[part]), to.eq(0)]
        carry = delayed(
            m, to, PACE - 1, reset_less=total.reset_less, name=f"{total.name}_carries_{late}"
        )
        restart = delayed(
            m, restart, PACE, init=total.reset_less, name=f"{total.name}_restart_{late}"
        )
