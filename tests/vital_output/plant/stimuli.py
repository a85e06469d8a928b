"""What drives relays and cross-link in the tests."""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
from hypothesis import strategies as st

from railgate.engines import Clock, Design, Engine, open_engine
from railgate.vital_output.plant.edges import FEMTOSECOND
from railgate.vital_output.plant.relay import DEFECTS, RelayTimes, combined
from railgate.waves import Trace, Waveform
from vital_output.small import SMALL

TIMES = RelayTimes(clock_hz=100_000, pick_up_s=Fraction(1, 1000), release_s=Fraction(7, 10_000))
"""A pulse train has 20 ticks, the relays pick up in 100 ticks and release in 70."""

FAST = RelayTimes(clock_hz=160_001, pick_up_s=Fraction(1, 10**6), release_s=Fraction(1, 10**4))
"""32 ticks; they pick up in one."""

DELAY_TICKS = 3
END = 30 * 10**12
"""Femtoseconds of a run: 30 ms."""


def plant_clocks(times: RelayTimes) -> tuple[Clock, Clock, Clock]:
    fpga = Fraction(SMALL.clock_hz)
    return (
        Clock(frequency_hz=fpga, domain="fpga_1", ppm=Fraction(100)),
        Clock(frequency_hz=fpga, domain="fpga_2", ppm=Fraction(-77), phase=Fraction(1, 3)),
        Clock(frequency_hz=Fraction(times.clock_hz), domain="relay", phase=Fraction(2, 7)),
    )


@cache
def opened(kind: str, times: RelayTimes) -> tuple[Engine, Any]:
    """A plant in an engine that is built once, and its state at tick 0."""
    from railgate.vital_output.plant.gateware import Plant

    design = Design(
        name="vital-output-plant",
        component=lambda: Plant(SMALL, times, DELAY_TICKS),
        clocks=plant_clocks(times),
    )
    engine = open_engine(design, kind)
    return engine, engine.checkpoint()


def through(kind: str, times: RelayTimes, inputs: Trace) -> Trace:
    engine, start = opened(kind, times)
    engine.restore(start)
    return engine.advance(inputs.end, inputs)


def trace(signals: dict[str, Waveform], end: int = END) -> Trace:
    return Trace(signals, FEMTOSECOND, 0, end)


def levels(times: list[int]) -> Waveform:
    """0 at first, another level with each of the times."""
    return Waveform.of([0, *sorted(times)], np.arange(len(times) + 1) & 1)


PARTS = st.one_of(
    st.sampled_from([Fraction(1), Fraction(9, 10), Fraction(11, 10)]),
    st.fractions(Fraction(3, 4), Fraction(5, 4), max_denominator=40),
)
"""Periods, as parts of the right one."""

BURSTS = st.tuples(PARTS, st.integers(-2, 2), st.integers(1, 40), st.sampled_from([0, 0, 1, 12]))
"""Period and what is added to it in relay ticks, number of pulses, and of periods of pause."""


@st.composite
def trains(draw: st.DrawFn, times: RelayTimes) -> Waveform:
    """Pulses of one output: bursts of periods about the right one, and pauses."""
    period, tick = 10**15 // SMALL.pulse_hz, 10**15 // times.clock_hz
    at, edges = draw(st.integers(0, 2 * period)), []
    for part, more, count, pause in draw(st.lists(BURSTS, max_size=8)):
        long = round(period * part) + more * tick
        high = draw(st.sampled_from([long // 2, long // 2, 2 * tick, long - 2 * tick]))
        for _ in range(count):
            edges += [at, at + high]
            at += long
        at += pause * period
    return levels([edge for edge in edges if 0 < edge < END])


@st.composite
def relay_runs(draw: st.DrawFn, times: RelayTimes) -> Trace:
    """Trains to both stages of each output, and any defects."""
    signals = {
        f"fpga_{c}.pulses": combined([draw(trains(times)) for _ in range(SMALL.outputs)])
        for c in (1, 2)
    }
    change = st.integers(1, END - 1)
    for name in draw(st.sets(st.sampled_from(DEFECTS))):
        waves = [
            levels(draw(st.lists(change, unique=True, max_size=5))) for _ in range(SMALL.outputs)
        ]
        signals[f"relay.{name}"] = combined(waves)
    return trace(signals)
