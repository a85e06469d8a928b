"""The measurement window: periods and sums between two snapshots."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.odometer.spec import Config
from railgate.primitives.chunked import accumulate, count, delayed, masked, skewed

__all__ = ["Window"]


class Window(wiring.Component):
    """Number of periods, first-to-last ticks and the two nested sums, from a boundary edge on.

    a_rise: in, 1 bit. broken: in, 1 bit, a reversal or an illegal transition. latch: in, 1 bit, in
    the tick after the strobe, in which the last edge is the boundary before this tick's own events.
    latch_soon: in, 1 bit, a tick before. elapsed, full: in, ticks since the boundary, and that they
    are period_max. moves: out, 1 bit, register, the last tick's edge was a new boundary, which
    `elapsed` need not tell before the next tick.
    window_seated: out, register, the field of that name; window_n a tick, window_ticks two, and,
    skewed, sum_a two and sum_b four ticks later.
    saturated, overflow, void: out, 1 bit, registers, why and that a seated window was lost in the
    tick before. Requirement ODO-10.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        super().__init__(
            {
                "a_rise": In(1),
                "broken": In(1),
                "latch": In(1),
                "latch_soon": In(1),
                "elapsed": In(config.period_bits),
                "full": In(1),
                "moves": Out(1),
                "window_seated": Out(1),
                "window_n": Out(config.window_bits),
                "window_ticks": Out(config.period_bits),
                "sum_a": Out(config.sum_a_bits),
                "sum_b": Out(config.sum_b_bits),
                "saturated": Out(1),
                "overflow": Out(1),
                "void": Out(1),
            }
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config = self._config

        no_more = Signal()  # n is window_pulses
        kept = self.window_seated & ~self.broken
        adds = self.a_rise & kept & ~self.full & ~no_more
        expires = self.window_seated & self.full & ~self.moves
        overflows = self.a_rise & kept & ~self.full & no_more
        voids = (self.window_seated & self.broken) | expires | overflows
        m.d.sync += [
            self.window_seated.eq(self.a_rise | (kept & ~expires)),
            self.moves.eq(self.a_rise & ~adds),
            self.saturated.eq(expires),
            self.overflow.eq(overflows),
            self.void.eq(voids),
        ]

        # What starts afresh with an edge in the tick of the latch counts it a tick later: there is
        # no edge in the next tick.
        postponed, added, fresh, ticks = Signal(), Signal(), Signal(), Signal.like(self.elapsed)
        m.d.sync += [
            postponed.eq(adds & self.latch),
            added.eq((adds & ~self.latch) | postponed),
            fresh.eq(voids | self.latch),
        ]
        with m.If(~postponed):
            m.d.sync += ticks.eq(self.elapsed)

        count(m, self.window_n, added, restart=fresh)
        most = config.window_pulses
        counted = Signal.like(self.window_n, init=(1 << config.window_bits) - 1 - most)
        over = count(m, counted, added, restart=self.latch_soon | self.latch | self.void)
        m.d.comb += no_more.eq(over | (added & (most == 1)))

        t = Signal.like(ticks)
        m.d.sync += t.eq(Mux(added, ticks, 0))
        added, fresh = delayed(m, Cat(added, fresh), 1, name="summed")
        with m.If(added | fresh):
            m.d.sync += self.window_ticks.eq(t)
        accumulate(m, self.sum_a, skewed(m, t), restart=fresh)
        added, fresh = delayed(m, Cat(added, fresh), 1, name="summed_a")
        sum_a = masked(m, self.sum_a, added, "sum_a_added")
        accumulate(m, self.sum_b, sum_a, restart=delayed(m, fresh, 1, name="fresh_b"))
        return m
