"""The measurement window: periods and sums between two snapshots."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.odometer.spec import Config
from railgate.primitives.chunked import accumulate, chunks, count, delayed, skewed, state_bits

__all__ = ["Window"]


class Window(wiring.Component):
    """Number of periods, first-to-last ticks and the two nested sums, from a boundary edge on.

    a_rise: in, 1 bit. broken: in, 1 bit, a reversal or an illegal transition. latch: in, 1 bit, in
    the tick after the strobe, before whose own events the last edge becomes the boundary.
    latch_soon: in, 2 bits, it will be in the next tick, in the one after that. since_rise: in, the
    state of the counter of ticks since the last rising edge of a, of the next tick.
    window_seated: out, register, the field of that name; so, a tick later, window_n; and, skewed,
    window_ticks a tick, sum_a two and sum_b three ticks later.
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
                "latch_soon": In(2),
                "since_rise": In(state_bits(config.period_bits)),
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
        seated = self.window_seated

        # Ticks since the boundary are those since the last edge, from a strobe or a new boundary
        # on; they are so one tick late after the latter, when no edge can be.
        moves = Signal()
        boundary = Signal()  # there was a new one in the tick before
        elapsed = Signal(config.period_bits)
        t = count(m, elapsed, saturates=True)
        with m.If(moves):
            m.d.sync += t.state.eq(self.since_rise)
        full = Signal()  # n is window_pulses

        kept = seated & ~self.broken
        adds = self.a_rise & kept & ~t.full & ~full
        expires = seated & t.full & ~boundary
        overflows = self.a_rise & kept & ~t.full & full
        voids = overflows | expires | (seated & self.broken)
        m.d.sync += [
            seated.eq(self.a_rise | (kept & ~expires)),
            boundary.eq(self.a_rise & ~adds),
            moves.eq((self.a_rise & ~adds) | self.latch_soon[1]),
            self.saturated.eq(expires),
            self.overflow.eq(overflows),
            self.void.eq(voids),
        ]

        added, fresh = Signal(), Signal()
        m.d.sync += [added.eq(adds), fresh.eq(voids | self.latch)]
        n, last = self.window_n, Signal()
        with m.If(fresh):
            m.d.sync += n.eq(added)
        with m.Elif(added):
            m.d.sync += n.eq(n + 1)
        m.d.sync += [
            last.eq(Mux(fresh, added, n) == config.window_pulses - 1),
            full.eq(
                Mux(fresh, added & (config.window_pulses == 1), full | (added & last))
                & ~self.latch_soon[0]
                & ~self.latch
            ),
        ]

        changes = added | fresh
        since = skewed(m, delayed(m, elapsed, 1, name="since"))
        takes, new = changes, added
        for part in chunks(config.period_bits):
            with m.If(takes):
                m.d.sync += self.window_ticks[part].eq(Mux(new, since[part], 0))
            takes, new = delayed(m, takes, 1, name="takes"), delayed(m, new, 1, name="new")
        changed, afresh = delayed(m, Cat(changes, fresh), 1, name="changed")
        accumulate(m, self.sum_a, self.window_ticks, fresh=afresh, enable=changed)
        changed, afresh = delayed(m, Cat(changed, afresh), 1, name="changed_a")
        accumulate(m, self.sum_b, self.sum_a, fresh=afresh, enable=changed)
        return m
