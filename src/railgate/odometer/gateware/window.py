"""The measurement window: periods and sums between two snapshots."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.odometer.spec import Config
from railgate.primitives.chunked import accumulate, count, delayed, masked, skewed

__all__ = ["SUM_BITS", "Window"]

SUM_BITS = 16
"""Of each chunk of the sums: as few as come to the snapshot in time."""


class Window(wiring.Component):
    """Number of periods, first-to-last ticks and the two nested sums, from a boundary edge on.

    a_rise: in, 1 bit. broken: in, 1 bit, a reversal or an illegal transition. latch: in, 1 bit, in
    the tick after the strobe, in which the last edge is the boundary before this tick's own events.
    latch_soon: in, 2 bits, it is in the next tick, in the one after that. elapsed, full: in, ticks
    since the boundary, and that they are period_max. moves: out, 1 bit, register, the last tick's
    edge was a new boundary, which `elapsed` need not tell before the next tick.
    window_seated: out, register, the field of that name; window_n two, window_ticks three, and,
    skewed, sum_a three and sum_b five ticks later.
    saturated, overflow, void: out, 1 bit, why and that a seated window was lost in the tick before.
    Requirement ODO-10.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        super().__init__(
            {
                "a_rise": In(1),
                "broken": In(1),
                "latch": In(1),
                "latch_soon": In(2),
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

        # What counts the window's periods until there are window_pulses starts afresh before the
        # latch, so that the edge in its tick counts.
        added = Signal()
        near = Signal(init=1)
        most = (1 << config.window_bits) - 1
        places = Signal.like(self.window_n, init=most - config.window_pulses, reset_less=True)
        no_more = count(m, places, added, restart=self.moves | near)

        seated = self.window_seated
        kept = seated & ~self.broken
        adds = self.a_rise & kept & ~self.full & ~no_more
        full = self.full & ~self.moves
        m.d.sync += [
            near.eq(self.latch_soon.any()),
            added.eq(adds),
            seated.eq(self.a_rise | (kept & ~full)),
            self.moves.eq(self.a_rise & ~adds),
        ]
        was_seated, rose, broken, full, no_more = delayed(
            m, Cat(seated, self.a_rise, self.broken, full, no_more), 1, name="before"
        )
        m.d.comb += [
            self.saturated.eq(was_seated & full),
            self.overflow.eq(was_seated & ~broken & ~full & rose & no_more),
            self.void.eq(was_seated & (broken | full | (rose & no_more))),
        ]

        # What the snapshot latches starts afresh after it, and the edge in the tick of the latch
        # is summed a tick later, unless the window is lost then: there is no edge in the next tick.
        latched = delayed(m, self.latch, 1, name="latched")
        postponed = Signal()
        sums = Signal()
        none = Signal(init=1)
        fresh = Signal(init=1)
        sums_soon = (added & ~latched) | (postponed & ~self.void)
        m.d.sync += [
            postponed.eq(added & latched),
            sums.eq(sums_soon),
            none.eq(~sums_soon),
            fresh.eq(self.void | latched),
        ]
        elapsed = delayed(m, self.elapsed, 1, reset_less=True, name="elapsed")
        ticks, t = (
            Signal.like(self.elapsed, reset_less=True, name=name) for name in ("ticks", "t")
        )
        with m.If(~postponed):
            m.d.sync += ticks.eq(elapsed)
        m.d.sync += t.eq(Mux(none, 0, ticks))

        n = Signal.like(self.window_n, reset_less=True)
        sum_a = Signal.like(self.sum_a, reset_less=True)
        sum_b = Signal.like(self.sum_b, reset_less=True)
        count(m, n, sums, restart=fresh)
        sums, fresh = delayed(m, sums, 1, name="sums"), delayed(m, fresh, 1, init=1, name="fresh")
        with m.If(sums | fresh):
            m.d.sync += self.window_ticks.eq(t)
        accumulate(m, sum_a, skewed(m, t, SUM_BITS, reset_less=True), SUM_BITS, restart=fresh)
        fresh = delayed(m, fresh, 2, init=1, name="fresh_b")
        summed = masked(m, sum_a, sums, SUM_BITS, name="summed")
        accumulate(m, sum_b, summed, SUM_BITS, restart=fresh)
        m.d.comb += [self.window_n.eq(n), self.sum_a.eq(sum_a), self.sum_b.eq(sum_b)]
        return m
