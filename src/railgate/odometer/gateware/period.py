"""Period and phase by equal-precision counting, and what is judged of each period."""

from __future__ import annotations

from amaranth.hdl import Module, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.odometer.spec import Config, Direction

__all__ = ["Period"]


class Period(wiring.Component):
    """Takes period and phase at every rising edge of a but the first.

    a_rise, b_rise: in, 1 bit. broken: in, 1 bit, a reversal or an illegal transition.
    elapsed: in, ticks since the last rising edge of a, staying at period_max.
    period, phase: out, ticks, registers. period_valid: out, 1 bit, register, the period is clean.
    phase_direction: out, 2 bits, register, see Direction.
    judged: out, 1 bit, a clean period closes in this tick. watched: out, 1 bit, it is no longer
    than watch_ticks. overspeed, phase_fault: out, 1 bit, in the tick of the closing edge.
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
                "elapsed": In(ticks),
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
        lag = Signal(config.period_bits)  # rising a to rising b, 0: none yet
        with m.If(self.broken):
            m.d.sync += broken.eq(1)
        with m.If(self.b_rise & (lag == 0)):
            m.d.sync += lag.eq(self.elapsed)
        with m.If(self.a_rise):
            m.d.sync += [begun.eq(1), broken.eq(0), lag.eq(0)]

        closes = self.a_rise & begun
        clean = ~broken & ~self.broken & (self.elapsed != config.period_max)
        direction = Signal(2)
        m.d.comb += direction.eq(_direction(m, self.elapsed, lag, clean))
        m.d.comb += [
            self.judged.eq(closes & clean),
            self.watched.eq(self.elapsed <= config.watch_ticks),
            self.overspeed.eq(self.judged & (self.elapsed < config.period_min_ticks)),
        ]
        with m.If(closes):
            m.d.sync += [
                self.period.eq(self.elapsed),
                self.phase.eq(lag),
                self.period_valid.eq(clean),
                self.phase_direction.eq(direction),
            ]

        before = Signal(range(config.phase_fault_periods))  # faulty ones just before this one
        faulty = self.judged & self.watched & (direction == Direction.NONE)
        last = before == config.phase_fault_periods - 1
        m.d.comb += self.phase_fault.eq(faulty & last)
        with m.If(faulty & ~last):
            m.d.sync += before.eq(before + 1)
        with m.Elif(closes & ~faulty):
            m.d.sync += before.eq(0)
        return m


def _direction(m: Module, period: Value, lag: Value, clean: Value) -> Value:
    """FORWARD within 90° ± 45°, REVERSE within 270° ± 45°, both inclusive, without multiplying."""
    eighths = lag << 3
    direction = Signal(2)
    with m.If(clean & (period <= eighths) & (eighths <= (period << 1) + period)):
        m.d.comb += direction.eq(Direction.FORWARD)
    with m.Elif(clean & ((period << 2) + period <= eighths) & (eighths + period <= period << 3)):
        m.d.comb += direction.eq(Direction.REVERSE)
    return direction
