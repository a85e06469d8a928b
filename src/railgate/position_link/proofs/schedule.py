"""The cycle as the contract has it, told by counting ticks alone."""

from __future__ import annotations

from fractions import Fraction

from amaranth.hdl import Cat, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import Out

from railgate.position_link.spec import Config
from railgate.proving import Internals

__all__ = ["Cycle"]


class Cycle(wiring.Component):
    """Where in its cycle the contract is, `late` ticks behind the line.

    edges: out, edges of CLK before this tick, in this cycle. edge: out, 1 bit, the next one is in
    this tick, the first that is not before its ideal instant. It starts at the end of a cycle, so
    that cycle 0 begins in tick 1 + late.

    A cycle is many equal stretches: at 40 MHz 1280 of 625 ticks with 16 edges each. Ticks are told
    as those of whole stretches and the rest, for solvers are slow at multiplying.
    """

    def __init__(self, config: Config, late: int = 0) -> None:
        rate = Fraction(2 * config.bits, config.ticks)
        self.stretch_edges, self.stretch_ticks = rate.numerator, rate.denominator
        self._stretches = config.cycle_ticks // self.stretch_ticks
        self.all_edges = 2 * config.cycle_bits
        start = divmod(config.cycle_ticks - 1 - late, self.stretch_ticks)
        count = -(-start[1] * self.stretch_edges // self.stretch_ticks)

        self._stretch = Signal(range(self._stretches), init=start[0])
        self._within = Signal(range(self.stretch_ticks), init=start[1])
        self._count = Signal(range(self.stretch_edges + 1), init=count)
        super().__init__({"edges": Out(range(self.all_edges + 1)), "edge": Out(1)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        ends = self._within == self.stretch_ticks - 1
        m.d.comb += [
            self.edge.eq(self.stretch_edges * self._within >= self.stretch_ticks * self._count),
            self.edges.eq(self.stretch_edges * self._stretch + self._count),
        ]
        m.d.sync += [
            self._within.eq(Mux(ends, 0, self._within + 1)),
            self._count.eq(Mux(ends, 0, self._count + self.edge)),
        ]
        with m.If(ends):
            last = self._stretch == self._stretches - 1
            m.d.sync += self._stretch.eq(Mux(last, 0, self._stretch + 1))
        return m

    def before(self, tick: int) -> Value:
        """This is before that tick of the cycle, the first one of which is 0."""
        stretch, within = divmod(tick, self.stretch_ticks)
        return (self._stretch < stretch) | ((self._stretch == stretch) & (self._within < within))

    def at(self, tick: int) -> Value:
        """This is that tick of the cycle."""
        stretch, within = divmod(tick, self.stretch_ticks)
        return (self._stretch == stretch) & (self._within == within)

    def follows(self, other: Cycle, ticks: int) -> Value:
        """This is so many ticks, less than a stretch, behind the other."""
        after = self._within + ticks
        same = (self._stretch == other._stretch) & (other._within == after)
        next_stretch = Mux(self._stretch == self._stretches - 1, 0, self._stretch + 1)
        next_one = (next_stretch == other._stretch) & (other._within + self.stretch_ticks == after)
        return Mux(after < self.stretch_ticks, same, next_one)

    @property
    def tick(self) -> Value:
        """The tick of the cycle."""
        return self.stretch_ticks * self._stretch + self._within

    @property
    def ahead(self) -> Value:
        """By how much the edges before this tick are ahead of this tick, in ticks / stretch_edges.

        The invariant of a fractional divider: 625 · edges - 16 · ticks at 40 MHz.
        """
        return self.stretch_ticks * self._count - self.stretch_edges * self._within

    def agrees(self, inner: Internals, path: str) -> Value:
        """The invariant that binds the bit clock `path` of the gateware to the ticks."""
        edges = self.edges + self.edge
        next_ahead = self.ahead + Mux(self.edge, self.stretch_ticks, 0) - self.stretch_edges
        return Cat(
            inner[f"{path}.divider.remainder"] == -next_ahead,
            inner[f"{path}.half"] == Mux(edges == self.all_edges, 0, edges),
            self._within < self.stretch_ticks,
            self._stretch < self._stretches,
            -self.stretch_edges < self.ahead,
            self.ahead <= self.stretch_ticks - self.stretch_edges,
        ).all()
