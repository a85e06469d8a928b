"""Registers that tell when something has upset them.

The ideas are OpenTitan's (prim_count, sparse state machines): what bounds a danger is held with so
much redundancy that no single flipped bit goes unnoticed. The redundancy is of no use to the logic,
so a synthesiser would merge it away: the registers carry the attribute `keep`, and a build must not
retime or share registers across them.
"""

from __future__ import annotations

from enum import IntEnum
from itertools import count

from amaranth.hdl import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["SparseState", "Twin"]

KEEP = {"keep": 1}
DISTANCE = 3


class Twin(wiring.Component):
    """A register of `width` bits that is held twice, once inverted; it starts as `init`.

    next: in, `width` bits, what it holds from the next tick on, in every tick. value: out, `width`
    bits, what it holds. error: out, 1 bit, the copies are not one another's inverse.

    Its registers are `value_copy` and `inverse_copy`. Requirement DRV-16.
    """

    def __init__(self, width: int, init: int = 0) -> None:
        self._width = width
        self._init = init
        super().__init__({"next": In(width), "value": Out(width), "error": Out(1)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inverted = ~self._init & (1 << self._width) - 1
        value_copy = Signal(self._width, init=self._init, attrs=KEEP)
        inverse_copy = Signal(self._width, init=inverted, attrs=KEEP)
        m.d.sync += [value_copy.eq(self.next), inverse_copy.eq(~self.next)]
        m.d.comb += [
            self.value.eq(value_copy),
            self.error.eq((value_copy ^ inverse_copy) != (1 << self._width) - 1),
        ]
        return m


class SparseState(wiring.Component):
    """A register for one of `states`, in a code whose words differ in at least 3 bits; it starts
    as `init`. So differ all words from 0 too: a register that is cleared is no state.

    next: in, the state that it holds from the next tick on, in every tick, as its plain number;
    what is none of the states becomes an error. value: out, the state's plain number, 0 where
    there is an error. error: out, 1 bit, the code is none.

    Its register is `code`. Requirement DRV-16.
    """

    def __init__(self, states: type[IntEnum], init: IntEnum) -> None:
        self._words = dict(zip(states, _words(len(states)), strict=True))
        self._init = init
        width = max(states).bit_length()
        super().__init__({"next": In(width), "value": Out(width), "error": Out(1)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        width = max(self._words.values()).bit_length()
        code = Signal(width, init=self._words[self._init], attrs=KEEP)
        following = Signal(width)
        m.d.sync += code.eq(following)
        with m.Switch(self.next):
            for state, word in self._words.items():
                with m.Case(state):
                    m.d.comb += following.eq(word)
        with m.Switch(code):
            for state, word in self._words.items():
                with m.Case(word):
                    m.d.comb += self.value.eq(state)
            with m.Default():
                m.d.comb += self.error.eq(1)
        return m


def _words(wanted: int) -> list[int]:
    """The first so many numbers that differ from one another, and from 0, in DISTANCE bits."""
    found = [0]
    for word in count(1):
        if len(found) > wanted:
            break
        if all((word ^ other).bit_count() >= DISTANCE for other in found):
            found.append(word)
    return found[1:]
