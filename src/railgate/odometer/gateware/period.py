"""Period and phase by equal-precision counting, and what is judged of each period."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal, Value, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.odometer.spec import Config, Direction
from railgate.primitives.chunked import PACE, accumulate, chunks, delayed, exceeds, skewed

__all__ = ["Period", "verdict_ticks"]


def verdict_ticks(config: Config) -> int:
    """From the closing edge of a period to the tick in which its phase is judged."""
    return 1 + PACE * (len(chunks(config.period_bits + 4)) - 1)


class Period(wiring.Component):
    """Takes period and phase at every rising edge of a but the first.

    a_rise_soon, b_rise_soon: in, 1 bit, there is a rising edge in the next tick. broken: in, 1 bit,
    a reversal or an illegal transition. restart: in, 1 bit, tick 0 or a rising edge of a. elapsed,
    since_rise, full: in, ticks since the last rising edge of a before this tick, the same as they
    stood after the tick before, both staying at period_max, and that `elapsed` is there.
    period_valid: out, 1 bit, register, the period is clean. period, phase: out, ticks, registers, a
    tick later.
    judged: out, 1 bit, a clean period was closed in the tick before. watched: out, 1 bit, it is no
    longer than watch_ticks. overspeed: out, 1 bit, it is shorter than period_min_ticks.
    phase_direction: out, 2 bits, register, see Direction, verdict_ticks later than the period.
    phase_fault: out, 1 bit, verdict_ticks + 1 after the closing edge.
    Requirements ODO-2, ODO-4, ODO-5.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        ticks = config.period_bits
        super().__init__(
            {
                "a_rise_soon": In(1),
                "b_rise_soon": In(1),
                "broken": In(1),
                "restart": In(1),
                "elapsed": In(ticks),
                "since_rise": In(ticks),
                "full": In(1),
                "period": Out(ticks),
                "phase": Out(ticks),
                "period_valid": Out(1),
                "phase_direction": Out(2),
                "judged": Out(1),
                "watched": Out(1),
                "overspeed": Out(1),
                "phase_fault": Out(1),
            }
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config = self._config

        # a has risen, b has risen since
        begun = Signal()
        seen = Signal()
        a_rise = Signal()
        first_b = Signal()
        closes = Signal()
        seen_soon = ~self.a_rise_soon & (seen | self.b_rise_soon)
        m.d.sync += [
            begun.eq(begun | self.a_rise_soon),
            seen.eq(seen_soon),
            a_rise.eq(self.a_rise_soon),
            first_b.eq(self.b_rise_soon & ~seen),
            closes.eq(self.a_rise_soon & begun),
        ]

        def longer(limit: int) -> Value:
            return exceeds(m, self.since_rise, limit - 1, restart=self.restart)

        broken = Signal()
        m.d.sync += broken.eq(~a_rise & (broken | self.broken))
        with m.If(closes):
            m.d.sync += self.period_valid.eq(~broken & ~self.broken & ~self.full)

        rose, takes, closed, slow, normal = delayed(
            m,
            Cat(
                a_rise,
                first_b,
                closes,
                longer(config.watch_ticks),
                longer(config.period_min_ticks - 1),
            ),
            1,
            name="closed",
        )
        elapsed = delayed(m, self.elapsed, 1, reset_less=True, name="elapsed")
        lag = Signal(config.period_bits, reset_less=True)  # rising a to rising b, 0: none yet
        with m.If(takes):
            m.d.sync += lag.eq(elapsed)
        with m.If(rose):
            m.d.sync += lag.eq(0)
        with m.If(closed):
            m.d.sync += [self.period.eq(elapsed), self.phase.eq(lag)]
        m.d.comb += [
            self.judged.eq(closed & self.period_valid),
            self.watched.eq(~slow),
            self.overspeed.eq(self.judged & ~normal),
        ]

        # FORWARD within 90° ± 45°, REVERSE within 270° ± 45°, both inclusive: as T and phase grow
        # by 1 in a tick, so do ± (8 · phase - n · T), whose signs tell.
        def reaches(sign: int, n: int) -> Value:
            shape = signed(config.period_bits + 4)
            both, period_alone = sign * (8 - n), -sign * n
            total = Signal(shape, init=both, reset_less=True, name=f"total_{n}")
            grows = Signal(shape, reset_less=True, name=f"grows_{n}")
            m.d.sync += grows.eq(Mux(seen_soon, period_alone, both))
            accumulate(m, total, skewed(m, grows, reset_less=True), restart=a_rise)
            return ~total[-1]

        forward = Signal()
        reverse = Signal()
        m.d.sync += [
            forward.eq(reaches(1, 1) & reaches(-1, 3)),
            reverse.eq(reaches(1, 5) & reaches(-1, 7)),
        ]

        late = verdict_ticks(config)
        closes, judged, watched = delayed(
            m, Cat(closed, self.judged, self.watched), late - 1, name="verdict"
        )
        direction = Mux(forward, Direction.FORWARD, Mux(reverse, Direction.REVERSE, Direction.NONE))
        with m.If(closes):
            m.d.sync += self.phase_direction.eq(Mux(judged, direction, Direction.NONE))

        faulty = Signal()
        fine = Signal()
        before = Signal(range(config.phase_fault_periods))  # faulty ones just before this one
        last = before == config.phase_fault_periods - 1
        m.d.sync += [
            faulty.eq(judged & watched & ~forward & ~reverse),
            fine.eq(closes & ~(judged & watched & ~forward & ~reverse)),
        ]
        m.d.comb += self.phase_fault.eq(faulty & last)
        with m.If(fine):
            m.d.sync += before.eq(0)
        with m.Elif(faulty & ~last):
            m.d.sync += before.eq(before + 1)
        return m
