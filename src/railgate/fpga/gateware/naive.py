"""An odometer written straight down from the contract: each field's arithmetic in one tick.

It has the ports and, tick for tick, the outputs of `Odometer`, stamps aside, and shares with it
nothing but the filter of its inputs and the shapes of its fields. What carries cut short cost and
gain is seen beside it.
"""

from __future__ import annotations

from amaranth.hdl import Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.odometer.gateware.sensor import shape
from railgate.odometer.spec import Config, Direction, Flag
from railgate.primitives import FilteredInput

__all__ = ["NaiveOdometer"]


class NaiveOdometer(wiring.Component):
    """Ports and contract as those of `Odometer`. Raises ValueError where there are stamps."""

    def __init__(self, config: Config) -> None:
        if config.stamp_depth:
            raise ValueError(f"stamp_depth must be 0, not {config.stamp_depth}")
        self._config = config
        pins = {"a": In(1), "b": In(1)}
        sensor = wiring.Signature(pins | {f.name: Out(shape(f)) for f in config.sensor_fields})
        super().__init__(
            {"strobe": In(1), "busy": Out(1), "sensor": Out(sensor).array(config.sensors)}
            | {field.name: Out(shape(field)) for field in config.common_fields}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        remaining = Signal(range(self._config.snapshot_latency_ticks))
        latch, publish = Signal(), remaining == 1
        opens = self.strobe & ~self.busy
        tick = Signal.like(self.time)
        time = Signal.like(self.time)
        m.d.comb += self.busy.eq(remaining != 0)
        m.d.sync += [tick.eq(tick + 1), latch.eq(opens)]
        with m.If(opens):
            m.d.sync += [remaining.eq(self._config.snapshot_latency_ticks - 1), time.eq(tick)]
        with m.Elif(self.busy):
            m.d.sync += remaining.eq(remaining - 1)
        with m.If(publish):
            m.d.sync += [self.number.eq(self.number + 1), self.time.eq(time)]

        for index, pins in enumerate(self.sensor):
            m.submodules[f"sensor_{index}"] = sensor = _Sensor(self._config)
            m.d.comb += [sensor.a.eq(pins.a), sensor.b.eq(pins.b), sensor.latch.eq(latch)]
            for field in self._config.sensor_fields:
                live, told = getattr(sensor, field.name), getattr(pins, field.name)
                latched = Signal.like(told, name=f"latched_{index}_{field.name}")
                with m.If(latch):
                    m.d.sync += latched.eq(live)
                with m.If(publish):
                    m.d.sync += told.eq(latched)
        return m


class _Sensor(wiring.Component):
    """a, b, latch: in, 1 bit; latch in the tick after a strobe. One out of each of sensor_fields,
    as it stood after the tick before."""

    def __init__(self, config: Config) -> None:
        self._config = config
        super().__init__(
            {name: In(1) for name in ("a", "b", "latch")}
            | {field.name: Out(shape(field)) for field in config.sensor_fields}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config = self._config
        m.submodules.input_a = a = FilteredInput(config.filter_ticks)
        m.submodules.input_b = b = FilteredInput(config.filter_ticks)
        a_edge, b_edge = a.rise | a.fall, b.rise | b.fall
        m.d.comb += [a.pin.eq(self.a), b.pin.eq(self.b)]
        m.d.sync += [
            self.level_a.eq(a.level),
            self.level_b.eq(b.level),
            self.a_rising.eq(self.a_rising + a.rise),
            self.b_rising.eq(self.b_rising + b.rise),
            self.rejected_glitches.eq(self.rejected_glitches + a.glitch + b.glitch),
        ]

        step = a_edge ^ b_edge
        leads = a.level ^ b.level ^ b_edge
        forward, reverse, illegal = step & leads, step & ~leads, a_edge & b_edge
        reversal = Signal()
        m.d.comb += reversal.eq(
            (forward & (self.direction == Direction.REVERSE))
            | (reverse & (self.direction == Direction.FORWARD))
        )
        with m.If(a_edge | b_edge):
            to = Mux(forward, Direction.FORWARD, Direction.REVERSE)
            m.d.sync += self.direction.eq(Mux(illegal, Direction.NONE, to))
        m.d.sync += [
            self.position.eq(self.position + forward - reverse),
            self.direction_changes.eq(self.direction_changes + reversal),
            self.illegal_transitions.eq(self.illegal_transitions + illegal),
        ]

        pulses = Mux(self.latch, 0, self.pulses)
        pulses_full = pulses == (1 << config.count_bits) - 1
        m.d.sync += self.pulses.eq(pulses + (a.rise & ~pulses_full))

        since_rise, reaches = _since(m, a.rise, self.since_rise, config.period_max)
        _since(m, a_edge | b_edge, self.since_edge, config.period_max)
        broken = reversal | illegal
        period_flags, judged, watched = self._period(m, a.rise, b.rise, broken, since_rise)
        window_flags, saturated = self._window(m, a.rise, broken)
        events = {
            Flag.GLITCH: a.glitch | b.glitch,
            Flag.REVERSAL: reversal,
            Flag.ILLEGAL: illegal,
            Flag.SATURATED: reaches | saturated | (a.rise & pulses_full),
            **period_flags,
            **window_flags,
            **self._watch(m, a.rise, b.rise, judged, watched),
        }
        happened = Signal(len(Flag))
        m.d.comb += [happened[flag.bit_length() - 1].eq(event) for flag, event in events.items()]
        m.d.sync += self.flags.eq(Mux(self.latch, 0, self.flags) | happened)
        return m

    def _period(
        self, m: Module, a_rise: Value, b_rise: Value, broken: Value, elapsed: Value
    ) -> tuple[dict[Flag, Value], Value, Value]:
        """Its flags; a clean period closes; it is no longer than watch_ticks."""
        config = self._config
        begun, dirty = Signal(), Signal()
        lag = Signal(config.period_bits)
        with m.If(broken):
            m.d.sync += dirty.eq(1)
        with m.If(b_rise & (lag == 0)):
            m.d.sync += lag.eq(elapsed)
        with m.If(a_rise):
            m.d.sync += [begun.eq(1), dirty.eq(0), lag.eq(0)]

        closes = a_rise & begun
        clean = ~dirty & ~broken & (elapsed != config.period_max)
        eighths = lag << 3
        leads = (elapsed <= eighths) & (eighths <= (elapsed << 1) + elapsed)
        lags = ((elapsed << 2) + elapsed <= eighths) & (eighths + elapsed <= elapsed << 3)
        direction = Mux(leads, Direction.FORWARD, Mux(lags, Direction.REVERSE, Direction.NONE))
        with m.If(closes):
            m.d.sync += [
                self.period.eq(elapsed),
                self.phase.eq(lag),
                self.period_valid.eq(clean),
                self.phase_direction.eq(Mux(clean, direction, Direction.NONE)),
            ]

        judged, watched = closes & clean, elapsed <= config.watch_ticks
        faulty = judged & watched & ~leads & ~lags
        before = Signal(range(config.phase_fault_periods))
        last = before == config.phase_fault_periods - 1
        with m.If(closes & ~(faulty & last)):
            m.d.sync += before.eq(Mux(faulty, before + 1, 0))
        flags = {
            Flag.OVERSPEED: judged & (elapsed < config.period_min_ticks),
            Flag.PHASE_FAULT: faulty & last,
        }
        return flags, judged, watched

    def _window(self, m: Module, a_rise: Value, broken: Value) -> tuple[dict[Flag, Value], Value]:
        """Its flags; a seated window is lost since it is too long."""
        config = self._config
        n, sum_a, sum_b = (
            Mux(self.latch, 0, field) for field in (self.window_n, self.sum_a, self.sum_b)
        )
        elapsed, now = Signal(config.period_bits), Signal(config.period_bits)
        m.d.comb += now.eq(Mux(self.latch, self.since_rise, elapsed) + 1)
        m.d.sync += elapsed.eq(now)

        saturated = self.window_seated & (now == config.period_max)
        lost = saturated | (self.window_seated & broken)
        goes_on = self.window_seated & ~lost
        overflow = a_rise & goes_on & (n == config.window_pulses)
        with m.If(self.latch | lost | overflow):
            fields = (self.window_n, self.window_ticks, self.sum_a, self.sum_b)
            m.d.sync += [field.eq(0) for field in fields]
        with m.If(lost):
            m.d.sync += self.window_seated.eq(0)
        with m.If(a_rise):
            m.d.sync += self.window_seated.eq(1)
            with m.If(goes_on & ~overflow):
                m.d.sync += [
                    self.window_n.eq(n + 1),
                    self.window_ticks.eq(now),
                    self.sum_a.eq(sum_a + now),
                    self.sum_b.eq(sum_b + sum_a + now),
                ]
            with m.Else():
                m.d.sync += elapsed.eq(0)
        flags = {Flag.WINDOW_VOID: lost | overflow, Flag.WINDOW_OVERFLOW: overflow}
        return flags, saturated

    def _watch(
        self, m: Module, a_rise: Value, b_rise: Value, judged: Value, watched: Value
    ) -> dict[Flag, Value]:
        """Its flags."""
        config = self._config
        rise = a_rise | b_rise
        since = Signal(range(config.watch_ticks + 2))
        now, _ = _since(m, rise, since, config.watch_ticks + 1)
        late = rise & (now > config.watch_ticks)
        armed = Signal()
        armed_now = Mux(judged, watched, armed & ~late)
        m.d.sync += armed.eq(armed_now)

        missing, seconds = [], []
        for name, own, other in (("a", a_rise, b_rise), ("b", b_rise, a_rise)):
            run = Signal(range(config.missing_pulses + 1), name=f"run_{name}")
            full = run == config.missing_pulses
            run_now = Mux(late, 1, Mux(full, run, run + 1))
            alone = own & ~other
            with m.If(rise):
                m.d.sync += run.eq(Mux(alone, run_now, 0))
            missing.append(alone & (run_now == config.missing_pulses))
            seconds.append(alone & armed_now & (run_now >= 2))
        b_missing, a_missing = missing
        return {
            Flag.A_MISSING: a_missing,
            Flag.B_MISSING: b_missing,
            Flag.MISMATCH: seconds[0] | seconds[1],
        }


def _since(m: Module, event: Value, ticks: Signal, limit: int) -> tuple[Value, Value]:
    """Drives `ticks`, those since an event or reset as after the tick before, `limit` at most.

    Gives those before this tick's event, and whether they are `limit` for the first time.
    """
    started = Signal(name=f"{ticks.name}_started")  # tick 0 itself is no tick after it
    now = Signal.like(ticks, name=f"{ticks.name}_now")
    full = ticks == limit
    m.d.comb += now.eq(Mux(full, limit, ticks + started))
    m.d.sync += [started.eq(1), ticks.eq(Mux(event, 0, now))]
    return now, (now == limit) & ~full
