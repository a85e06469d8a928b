"""One two-channel sensor: from its pins to the fields that a snapshot latches."""

from __future__ import annotations

from collections.abc import Iterator

from amaranth.hdl import Cat, Module, Mux, Shape, Signal, Value
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out

from railgate.odometer.gateware.period import Period, verdict_ticks
from railgate.odometer.gateware.stamps import STAMP_LAYOUT, Stamps
from railgate.odometer.gateware.steps import Ages, Steps
from railgate.odometer.gateware.watch import Watch
from railgate.odometer.gateware.window import SUM_BITS, Window
from railgate.odometer.spec import Config, Field, Flag
from railgate.primitives import FilteredInput
from railgate.primitives.chunked import CHUNK_BITS, PACE, accumulate, chunks, count, delayed, skewed

__all__ = ["LATE", "Sensor", "settled", "shape"]

LATE = 3
"""Ticks by which a sensor takes edges and strobes later than they are, but where it says so."""


SKEWED = {
    "position": CHUNK_BITS,
    "rejected_glitches": CHUNK_BITS,
    "sum_a": SUM_BITS,
    "sum_b": SUM_BITS,
}
"""Fields that are sums, and the bits of each of their chunks."""


def shape(field: Field) -> Shape:
    """The shape of a snapshot's field."""
    return Shape(field.width, field.signed)


def settled(config: Config, field: Field) -> Iterator[tuple[slice, int]]:
    """How many ticks after that of the latch which bits of a sensor's field are what it latches."""
    late = LATE + {
        "period": 1,
        "phase": 1,
        "window_n": 2,
        "window_ticks": 3,
        "sum_a": 3,
        "sum_b": 5,
        "phase_direction": verdict_ticks(config),
        "flags": verdict_ticks(config) + 2,
    }.get(field.name, 0)
    bits = SKEWED.get(field.name, field.width)
    for index, part in enumerate(chunks(field.width, bits)):
        yield part, late + PACE * index


class Sensor(wiring.Component):
    """All that is counted and measured of one sensor.

    a, b: in, 1 bit, the pins, asynchronous. latches: in, bit n is the latch of n ticks ago, in the
    tick after a strobe; `pulses`, `flags` and window start afresh, before the events of this tick.
    ticks: in, the tick before, modulo 2³².
    One out of each of config.sensor_fields, late as `settled` tells.
    stamps: out, stream of STAMP_LAYOUT, only where stamp_depth > 0.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        members = {"a": In(1), "b": In(1), "latches": In(config.snapshot_latency_ticks - 1)}
        members |= {field.name: Out(shape(field)) for field in config.sensor_fields}
        if config.stamp_depth:
            members["ticks"] = In(STAMP_LAYOUT["ticks"].width)
            members["stamps"] = Out(stream.Signature(STAMP_LAYOUT))
        super().__init__(members)

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config = self._config
        latch = delayed(m, self.latches[LATE - 1], 1, reset_less=True, name="latch")
        events: dict[Flag, tuple[Value, int]] = {}  # with their ticks after LATE

        m.submodules.input_a = a = FilteredInput(config.filter_ticks)
        m.submodules.input_b = b = FilteredInput(config.filter_ticks)
        m.d.comb += [a.pin.eq(self.a), b.pin.eq(self.b)]

        # A tick late: the edges, and tick 0.
        start = delayed(m, delayed(m, 0, 1, init=1, name="tick_0"), 1, init=1, name="start")
        a_rise, a_edge, a_level, b_rise, b_edge, b_level = delayed(
            m,
            Cat(a.rise, a.rise | a.fall, a.level, b.rise, b.rise | b.fall, b.level),
            1,
            name="pins",
        )
        m.submodules.steps = steps = Steps()
        m.d.comb += [
            steps.a.eq(a_level),
            steps.b.eq(b_level),
            steps.a_edge.eq(a_edge),
            steps.b_edge.eq(b_edge),
            self.direction.eq(steps.direction),
        ]
        if config.stamp_depth:
            m.submodules.stamps = stamps = Stamps(config)
            m.d.comb += [
                stamps.edge.eq(a_edge | b_edge),
                stamps.ticks.eq(self.ticks),
                stamps.a.eq(a_level),
                stamps.b.eq(b_level),
            ]
            wiring.connect(m, stamps.stamps, wiring.flipped(self.stamps))
            events[Flag.STAMP_OVERFLOW] = stamps.overflow, -2

        # LATE, as the steps are, or a tick before.
        start = delayed(m, start, 1, init=1, name="start")
        a_soon, b_soon, a_level, b_level = delayed(
            m, Cat(a_rise, b_rise, a_level, b_level), 1, name="edges"
        )
        a_edge, b_edge = delayed(m, Cat(a_edge, b_edge), 1, name="steps")
        a_rise, b_rise = delayed(m, Cat(a_soon, b_soon), 1, name="rises")
        a_level, b_level = delayed(m, Cat(a_level, b_level), 1, name="levels")
        restart_edge = delayed(m, a_edge | b_edge | start, 1, init=1, name="restart_edge")
        restart_either = delayed(m, a_soon | b_soon | start, 1, init=1, name="restart_either")
        glitches = delayed(m, a.glitch + b.glitch, LATE, name="glitches")
        m.d.sync += [self.level_a.eq(a_level), self.level_b.eq(b_level)]
        step = Signal.like(self.position)
        m.d.comb += step.eq(steps.step)
        accumulate(m, self.position, skewed(m, step, name="step"))
        accumulate(m, self.rejected_glitches, skewed(m, glitches, name="glitch"))
        count(m, self.a_rising, a_rise)
        count(m, self.b_rising, b_rise)
        count(m, self.direction_changes, steps.reversal)
        count(m, self.illegal_transitions, steps.illegal)
        # An edge in the tick of the latch is counted a tick later: there is none in the next tick.
        latch_soon = self.latches[LATE - 1]
        counted = Signal()
        m.d.sync += counted.eq((a_soon & ~latch_soon) | (a_rise & latch))
        pulses_full = count(m, self.pulses, counted, restart=latch, saturates=True)
        events[Flag.REVERSAL] = steps.reversal, 0
        events[Flag.ILLEGAL] = steps.illegal, 0
        events[Flag.GLITCH] = glitches.any(), 0

        m.submodules.window = window = Window(config)
        m.submodules.ages = ages = Ages(config.period_bits)
        m.d.comb += [
            ages.tick_0_soon.eq(start),
            ages.edge_soon.eq(a_soon),
            ages.moves_soon.eq(latch_soon | window.moves),
            self.since_rise.eq(ages.since_last),
            window.a_rise.eq(a_rise),
            window.broken.eq(steps.broken),
            window.latch.eq(latch),
            window.latch_soon.eq(Cat(latch_soon, self.latches[LATE - 2])),
            window.elapsed.eq(ages.boundary),
            window.full.eq(ages.boundary_full),
            self.window_seated.eq(window.window_seated),
            self.window_n.eq(window.window_n),
            self.window_ticks.eq(window.window_ticks),
            self.sum_a.eq(window.sum_a),
            self.sum_b.eq(window.sum_b),
        ]
        events[Flag.WINDOW_VOID] = window.void, 1
        events[Flag.WINDOW_OVERFLOW] = window.overflow, 1
        edge_age = Signal.like(self.since_edge, init=1, reset_less=True)
        since_edge = Signal.like(self.since_edge, reset_less=True)
        count(m, edge_age, restart=restart_edge, saturates=True)
        m.d.sync += since_edge.eq(Mux(restart_edge, 0, edge_age))
        m.d.comb += self.since_edge.eq(since_edge)
        reaches = ages.last_full & ~delayed(m, ages.last_full, 1, name="was_full")
        full = delayed(m, reaches | (counted & pulses_full), 1, name="full")
        events[Flag.SATURATED] = window.saturated | full, 1

        m.submodules.period = period = Period(config)
        m.d.comb += [
            period.a_rise_soon.eq(a_soon),
            period.b_rise_soon.eq(b_soon),
            period.broken.eq(steps.broken),
            period.restart.eq(ages.restarts),
            period.elapsed.eq(ages.last),
            period.since_rise.eq(ages.since_last),
            period.full.eq(ages.last_full),
            self.period.eq(period.period),
            self.period_valid.eq(period.period_valid),
            self.phase.eq(period.phase),
            self.phase_direction.eq(period.phase_direction),
        ]
        events[Flag.OVERSPEED] = period.overspeed, 1
        events[Flag.PHASE_FAULT] = period.phase_fault, verdict_ticks(config) + 1

        m.submodules.watch = watch = Watch(config)
        m.d.comb += [
            watch.restart.eq(restart_either),
            watch.a_rise.eq(a_rise),
            watch.b_rise.eq(b_rise),
            watch.judged.eq(period.judged),
            watch.watched.eq(period.watched),
        ]
        events[Flag.MISMATCH] = watch.mismatch, 2
        events[Flag.A_MISSING] = watch.a_missing, 1
        events[Flag.B_MISSING] = watch.b_missing, 1

        told = verdict_ticks(config) + 2
        happened = Signal(len(Flag))
        m.d.comb += [
            happened[flag.bit_length() - 1].eq(
                delayed(m, event, told - late, name=f"flag_{flag:d}")
            )
            for flag, (event, late) in events.items()
        ]
        m.d.sync += self.flags.eq(Mux(self.latches[LATE + told], 0, self.flags) | happened)
        return m
