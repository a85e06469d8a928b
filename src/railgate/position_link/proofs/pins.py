"""The levels behind the filters as the contract has them, told from the pins' past alone."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.proving import Internals

__all__ = ["Level"]

SEATED = 3
"""The tick in which the pin's level at start is the filtered one."""


class Level(wiring.Component):
    """A pin's level, once it was held for more than `filter_ticks`, 3 + filter_ticks late.

    past: the pin's levels, bit n that of n + 1 ticks ago. tick: since reset, SEATED + 1 at most.
    before: `level` a tick ago.

    pin: in, 1 bit. level: out, 1 bit. rise, fall: out, 1 bit, it is new in this tick; the level at
    start is no edge.
    """

    def __init__(self, filter_ticks: int) -> None:
        self._filter_ticks = filter_ticks
        self.past = Signal(SEATED + filter_ticks)
        self.tick = Signal(range(SEATED + 2))
        self.before = Signal()
        super().__init__({name: Out(1) for name in ("level", "rise", "fall")} | {"pin": In(1)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        tick, held = self.tick, self.past[SEATED - 1 :]
        told = tick == SEATED + 1
        m.d.sync += [
            self.past.eq(Cat(self.pin, self.past)),
            tick.eq(Mux(told, tick, tick + 1)),
            self.before.eq(self.level),
        ]
        m.d.comb += [
            self.rise.eq(told & held.all() & ~self.before),
            self.fall.eq(told & ~held.any() & self.before),
            self.level.eq(Mux(told, self.before ^ (self.rise | self.fall), 0)),
        ]
        with m.If(tick == SEATED):
            m.d.comb += self.level.eq(held[0])
        return m

    def agrees(self, inner: Internals, path: str) -> Value:
        """The invariant that binds the input `path` of the gateware to the pin's past."""
        held, past = inner[f"{path}.held"], self.past[SEATED - 1 :]
        other = past ^ self.level.replicate(len(past))
        runs = [
            (held == n) & (self.tick >= SEATED + min(n, 1)) & other[:n].all() & ~other[n]
            for n in range(len(past))
        ]
        return Cat(
            inner[f"{path}.synchroniser.stage0"] == self.past[0],
            inner[f"{path}.synchroniser.stage1"] == self.past[1],
            inner[f"{path}.seats"] == (1 << self.tick)[:SEATED],
            (self.tick > 1) | ((self.past >> self.tick)[:2] == 0),
            inner[f"{path}.level"] == self.level,
            inner[f"{path}.rise"] == self.rise,
            inner[f"{path}.fall"] == self.fall,
            self.tick <= SEATED + 1,
            Mux(self.tick < SEATED, held == 0, Cat(*runs).any()),
            *(
                [inner[f"{path}.full"] == ((held == len(past) - 1) | (self.tick == SEATED - 1))]
                if len(past) > 1
                else []
            ),
        ).all()
