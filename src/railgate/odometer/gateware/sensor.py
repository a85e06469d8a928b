"""One two-channel sensor: from its pins to the fields that a snapshot latches."""

from __future__ import annotations

from amaranth.hdl import Module, Mux, Shape, Signal
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out

from railgate.odometer.gateware.period import Period
from railgate.odometer.gateware.stamps import STAMP_LAYOUT, Stamps
from railgate.odometer.gateware.steps import Elapsed, Steps
from railgate.odometer.gateware.watch import Watch
from railgate.odometer.gateware.window import Window
from railgate.odometer.spec import Config, Field, Flag
from railgate.primitives import FilteredInput

__all__ = ["Sensor", "shape"]


def shape(field: Field) -> Shape:
    """The shape of a snapshot's field."""
    return Shape(field.width, field.signed)


class Sensor(wiring.Component):
    """All that is counted and measured of one sensor.

    a, b: in, 1 bit, the pins, asynchronous. latch: in, 1 bit, in the tick after a strobe, in which
    the fields are what it latches; `pulses`, `flags` and window then start afresh, before the
    events of this tick. ticks: in, the tick, modulo 2³².
    One out of each of config.sensor_fields, as it stood after the tick before.
    stamps: out, stream of STAMP_LAYOUT, only where stamp_depth > 0.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        members = {"a": In(1), "b": In(1), "latch": In(1)}
        members |= {field.name: Out(shape(field)) for field in config.sensor_fields}
        if config.stamp_depth:
            members["ticks"] = In(STAMP_LAYOUT["ticks"].width)
            members["stamps"] = Out(stream.Signature(STAMP_LAYOUT))
        super().__init__(members)

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config = self._config
        events = dict.fromkeys(Flag, 0)

        m.submodules.input_a = a = FilteredInput(config.filter_ticks)
        m.submodules.input_b = b = FilteredInput(config.filter_ticks)
        m.d.comb += [a.pin.eq(self.a), b.pin.eq(self.b)]
        m.d.sync += [self.level_a.eq(a.level), self.level_b.eq(b.level)]
        a_edge, b_edge = a.rise | a.fall, b.rise | b.fall
        m.d.sync += self.rejected_glitches.eq(self.rejected_glitches + a.glitch + b.glitch)
        events[Flag.GLITCH] = a.glitch | b.glitch

        m.submodules.since_rise = since_rise = Elapsed(config.period_max)
        m.submodules.since_edge = since_edge = Elapsed(config.period_max)
        m.d.comb += [
            since_rise.restart.eq(a.rise),
            since_edge.restart.eq(a_edge | b_edge),
            self.since_rise.eq(since_rise.ticks),
            self.since_edge.eq(since_edge.ticks),
        ]

        m.submodules.steps = steps = Steps()
        m.d.comb += [
            steps.a.eq(a.level),
            steps.b.eq(b.level),
            steps.a_edge.eq(a_edge),
            steps.b_edge.eq(b_edge),
            self.direction.eq(steps.direction),
        ]
        m.d.sync += [
            self.position.eq(self.position + steps.forward - steps.reverse),
            self.direction_changes.eq(self.direction_changes + steps.reversal),
            self.illegal_transitions.eq(self.illegal_transitions + steps.illegal),
        ]
        events[Flag.REVERSAL] = steps.reversal
        events[Flag.ILLEGAL] = steps.illegal
        broken = steps.reversal | steps.illegal

        pulses = Mux(self.latch, 0, self.pulses)
        pulses_full = pulses == (1 << config.count_bits) - 1
        m.d.sync += [
            self.pulses.eq(pulses + (a.rise & ~pulses_full)),
            self.a_rising.eq(self.a_rising + a.rise),
            self.b_rising.eq(self.b_rising + b.rise),
        ]

        m.submodules.period = period = Period(config)
        m.d.comb += [
            period.a_rise.eq(a.rise),
            period.b_rise.eq(b.rise),
            period.broken.eq(broken),
            period.elapsed.eq(since_rise.now),
            self.period.eq(period.period),
            self.period_valid.eq(period.period_valid),
            self.phase.eq(period.phase),
            self.phase_direction.eq(period.phase_direction),
        ]
        events[Flag.OVERSPEED] = period.overspeed
        events[Flag.PHASE_FAULT] = period.phase_fault

        m.submodules.window = window = Window(config)
        m.d.comb += [
            window.a_rise.eq(a.rise),
            window.broken.eq(broken),
            window.latch.eq(self.latch),
            window.since_rise.eq(since_rise.ticks),
            self.window_seated.eq(window.window_seated),
            self.window_n.eq(window.window_n),
            self.window_ticks.eq(window.window_ticks),
            self.sum_a.eq(window.sum_a),
            self.sum_b.eq(window.sum_b),
        ]
        events[Flag.WINDOW_VOID] = window.void
        events[Flag.WINDOW_OVERFLOW] = window.overflow
        events[Flag.SATURATED] = since_rise.reaches | window.saturated | (a.rise & pulses_full)

        m.submodules.watch = watch = Watch(config)
        m.d.comb += [
            watch.a_rise.eq(a.rise),
            watch.b_rise.eq(b.rise),
            watch.judged.eq(period.judged),
            watch.watched.eq(period.watched),
        ]
        events[Flag.MISMATCH] = watch.mismatch
        events[Flag.A_MISSING] = watch.a_missing
        events[Flag.B_MISSING] = watch.b_missing

        if config.stamp_depth:
            m.submodules.stamps = stamps = Stamps(config)
            m.d.comb += [
                stamps.edge.eq(a_edge | b_edge),
                stamps.ticks.eq(self.ticks),
                stamps.a.eq(a.level),
                stamps.b.eq(b.level),
            ]
            wiring.connect(m, stamps.stamps, wiring.flipped(self.stamps))
            events[Flag.STAMP_OVERFLOW] = stamps.overflow

        happened = Signal(len(Flag))
        m.d.comb += [happened[flag.bit_length() - 1].eq(event) for flag, event in events.items()]
        m.d.sync += self.flags.eq(Mux(self.latch, 0, self.flags) | happened)
        return m
