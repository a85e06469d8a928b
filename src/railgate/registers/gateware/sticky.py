"""Bits that stay set until they are cleared."""

from __future__ import annotations

from amaranth.hdl import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["Sticky"]


class Sticky(wiring.Component):
    """`width` bits, each set by its own of `sets` and cleared by its own of `clears`.

    sets, clears: in. Of both in one tick setting wins, so that no event is lost. held: out,
    registers.
    """

    def __init__(self, width: int) -> None:
        super().__init__({"sets": In(width), "clears": In(width), "held": Out(width)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.d.sync += self.held.eq((self.held & ~self.clears) | self.sets)
        return m
