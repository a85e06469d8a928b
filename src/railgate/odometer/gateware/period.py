"""Period and phase by equal-precision counting, and what is judged of each period."""

from __future__ import annotations

from amaranth.hdl import Const, Module, Mux, Signal, Value, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.odometer.spec import Config, Direction
from railgate.primitives.chunked import accumulate, chunks, delayed, exceeds, skewed

__all__ = ["Period", "verdict_ticks"]


def verdict_ticks(config: Config) -> int:
    """From the closing edge of a period to the tick in which its phase is judged."""
    return len(chunks(config.period_bits + 4))


class Period(wiring.Component):
    """Takes period and phase at every rising edge of a but the first.

    a_rise, b_rise: in, 1 bit. broken: in, 1 bit, a reversal or an illegal transition.
    restart: in, 1 bit, tick 0 or a rising edge of a. elapsed, full: in, ticks since the last
    rising edge of a, staying at period_max, and that they do.
    period, phase: out, ticks, registers. period_valid: out, 1 bit, register, the period is clean.
    judged: out, 1 bit, a clean period closes in this tick. watched: out, 1 bit, it is no longer
    than watch_ticks. overspeed: out, 1 bit, in the tick of the closing edge.
    phase_direction: out, 2 bits, register, see Direction, and phase_fault: out, 1 bit, both
    verdict_ticks later than the other ones.
    Requirements ODO-2, ODO-4, ODO-5.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        ticks = config.period_bits
        super().__init__(
            {
                "a_rise": In(1),
                "b_rise": In(1),
                "broken": In(1),
                "restart": In(1),
                "elapsed": In(ticks),
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

        begun = Signal()
        broken = Signal()
        seen = Signal()  # b has risen since a has
        lag = Signal(config.period_bits)  # rising a to rising b, 0: none yet
        with m.If(self.broken):
            m.d.sync += broken.eq(1)
        with m.If(self.b_rise & ~seen):
            m.d.sync += [seen.eq(1), lag.eq(self.elapsed)]
        with m.If(self.a_rise):
            m.d.sync += [begun.eq(1), broken.eq(0), seen.eq(0), lag.eq(0)]

        closes = self.a_rise & begun
        clean = ~broken & ~self.broken & ~self.full
        fast = ~exceeds(m, self.elapsed, config.period_min_ticks - 1, clear=self.restart)
        slow = exceeds(m, self.elapsed, config.watch_ticks, clear=self.restart)
        m.d.comb += [
            self.judged.eq(closes & clean),
            self.watched.eq(~slow),
            self.overspeed.eq(self.judged & fast),
        ]
        with m.If(closes):
            m.d.sync += [
                self.period.eq(self.elapsed),
                self.phase.eq(lag),
                self.period_valid.eq(clean),
            ]

        # FORWARD within 90° ± 45°, REVERSE within 270° ± 45°, both inclusive: as T and phase grow,
        # so do ± (8 · phase - n · T), whose signs tell.
        fresh = delayed(m, self.a_rise, 1, name="fresh")

        def reaches(sign: int, eighths: int) -> Value:
            of = Signal(signed(config.period_bits + 4), name=f"eighths_{eighths}")
            grows = Mux(seen, Const(-sign * eighths, of.shape()), Const(sign * (8 - eighths), of.shape()))
            accumulate(m, of, skewed(m, grows, name=f"{of.name}_grows"), fresh=fresh)
            return ~of[-1]

        forward = reaches(1, 1) & reaches(-1, 3)
        reverse = reaches(1, 5) & reaches(-1, 7)

        late = verdict_ticks(config)
        closes = delayed(m, closes, late, name="closes")
        judged = delayed(m, self.judged, late, name="judged")
        watched = delayed(m, self.watched, late, name="watched")
        with m.If(closes):
            m.d.sync += self.phase_direction.eq(
                Mux(
                    judged & forward,
                    Direction.FORWARD,
                    Mux(judged & reverse, Direction.REVERSE, Direction.NONE),
                )
            )
        before = Signal(range(config.phase_fault_periods))  # faulty ones just before this one
        faulty = judged & watched & ~forward & ~reverse
        last = before == config.phase_fault_periods - 1
        m.d.comb += self.phase_fault.eq(faulty & last)
        with m.If(faulty & ~last):
            m.d.sync += before.eq(before + 1)
        with m.Elif(closes & ~faulty):
            m.d.sync += before.eq(0)
        return m
