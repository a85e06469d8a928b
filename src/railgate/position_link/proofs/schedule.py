"""The cycle as the contract has it, told by counting ticks alone."""

from __future__ import annotations

from fractions import Fraction

from amaranth.hdl import Cat, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import Out

from railgate.position_link.spec import Config
from railgate.proving import Internals

__all__ = ["CHUNK_BITS", "Cycle"]

CHUNK_BITS = 4
"""Of the gateware's counters."""


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
        self._late = late
        if late:
            self._marks = {
                "starts": 0,
                "opens": 2 * (config.earliest_clk - 1),
                "closes": 2 * config.window_bits,
                "decides": 2 * (config.window_bits + config.word_bits + 1),
            }
        else:
            self._marks = {
                "begins": 0,
                "request_ends": 2 * config.request_bits,
                "frame_starts": 2 * config.radio_first,
            }
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
        ahead, coming = [self.ahead], []  # in this tick, the next, …; there is an edge in it
        for _ in range(3):
            coming.append(ahead[-1] <= 0)
            ahead.append(ahead[-1] + Mux(coming[-1], self.stretch_ticks, 0) - self.stretch_edges)
        told = (self.edges + coming[0])[: len(self.edges)]  # the number of the edge after this tick
        return Cat(
            inner[f"{path}.divider.remainder"] == -ahead[3],
            inner[f"{path}.divider.strobe"] == (ahead[3] <= 0),
            inner[f"{path}.edge"] == coming[2],
            inner[f"{path}.clk"] == told[0],
            inner[f"{path}.rises"] == (coming[1] & ~told[0]),
            inner[f"{path}.falls"] == (coming[1] & told[0]),
            *(
                inner[f"{path}.{name}"] == (coming[1] & self._is(told, number))
                for name, number in self._marks.items()
            ),
            self._counts(inner, f"{path}.half", told + coming[1], Cat(coming[:2])),
            self._within < self.stretch_ticks,
            self._stretch < self._stretches,
            -self.stretch_edges < self.ahead,
            self.ahead <= self.stretch_ticks - self.stretch_edges,
        ).all()

    def _is(self, number: Value, edge: int) -> Value:
        """That number, of this cycle's end too, is this edge's."""
        return (number == edge) | (number == edge + self.all_edges)

    def _counts(self, inner: Internals, path: str, number: Value, changed: Value) -> Value:
        """The counter `path` is at that number, and what it looks ahead is right, unless the value
        has changed in this tick (changed[1]) or, but for its chunks, in the one before."""
        first = int(not self._late)
        value = inner[f"{path}.value"]
        number = (number - first)[: len(value) + 1]
        wrapped = Mux(number >= self.all_edges, number - self.all_edges, number)
        marks = {name: (edge - first) % self.all_edges for name, edge in self._marks.items()}
        marks["last"] = self.all_edges - 1
        chunks = [value[at : at + CHUNK_BITS] for at in range(0, len(value), CHUNK_BITS)]
        full = [chunk.all() for chunk in chunks]
        last = value == self.all_edges - 1
        parts, wholes = [inner[f"{path}.full"] == Cat(full)], []
        for name, edge in marks.items():
            split = [edge >> at for at in range(0, len(value), CHUNK_BITS)]
            fits = Cat(
                chunk == part % (1 << len(chunk)) for chunk, part in zip(chunks, split, strict=True)
            )
            parts.append(inner[f"{path}.at_{name}"] == fits)
            wholes.append(inner[f"{path}.{name}"] == (value == edge))
        for n, _ in enumerate(chunks):
            lacks = -((self.all_edges - 1) >> n * CHUNK_BITS)
            carry = Cat(full[:n]).all()
            carries = carry | last if lacks & 1 else carry & ~last
            wholes.append(inner[f"{path}.carries"][n] == carries)
        return Cat(
            value == wrapped,
            changed[1] | Cat(parts).all(),
            changed.any() | Cat(wholes).all(),
        ).all()
