"""Gateware and model are the same, tick for tick (SYS-2)."""

from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from odometer.stimuli import stimuli, trace
from railgate.engines import Engine, open_engine
from railgate.odometer.design import design
from railgate.odometer.measure import stimulus
from railgate.odometer.spec import Config
from railgate.waves import Trace, Waveform, read

pytestmark = pytest.mark.shows("SYS-2")

CAPTURES = sorted((Path(__file__).parents[1] / "data" / "sigrok").glob("*.sr"))
AXES = {"X": ["XA", "XB"], "Y": ["YA", "YB"]}
EVERY = Fraction(1, 50)
SLICE_TICKS = 50_000

every_pair = pytest.mark.parametrize(
    ("capture", "axis"),
    [(path, axis) for path in CAPTURES for axis in AXES],
    ids=[f"{path.stem}-{axis}" for path in CAPTURES for axis in AXES],
)


def pins(capture: Path, axis: str) -> Trace:
    a, b = AXES[axis]
    return read(capture, [a, b]).rename({a: "a", b: "b"})


def through(kind: str, config: Config, inputs: Trace) -> Trace:
    return open_engine(design(config), kind).advance(inputs.end, inputs)


def assert_equal(config: Config, inputs: Trace, *kinds: str) -> Trace:
    first, *others = (through(kind, config, inputs) for kind in kinds)
    for kind, other in zip(kinds[1:], others, strict=True):
        difference = first.first_difference(other)
        assert difference is None, f"{kinds[0]} and {kind} part: {difference}"
    return first


def test_there_are_captures() -> None:
    assert len(CAPTURES) == 4


@every_pair
def test_leap_is_cxxrtl_on_every_whole_capture(capture: Path, axis: str) -> None:
    config = Config(sensors=1, stamp_depth=16)
    result = assert_equal(config, stimulus(pins(capture, axis), config, EVERY), "leap", "cxxrtl")
    assert len(result["number"]) > 100


def test_leap_is_cxxrtl_with_two_axles_and_a_filter() -> None:
    config = Config(filter_ticks=100, stamp_depth=16)
    both = read(CAPTURES[1], ["XA", "XB", "YA", "YB"])
    x = stimulus(both.select(["XA", "XB"]).rename({"XA": "a", "XB": "b"}), config, EVERY)
    y = stimulus(both.select(["YA", "YB"]).rename({"YA": "a", "YB": "b"}), config, EVERY)
    second = {"sensor.0.a": "sensor.1.a", "sensor.0.b": "sensor.1.b"}
    inputs = x.merge(y.select(second).rename(second))
    result = assert_equal(config, inputs, "leap", "cxxrtl")
    assert result["sensor.0.a_rising"].values[-1] > 100
    assert result["sensor.1.a_rising"].values[-1] > 100


def events(trace: Trace) -> list[int]:
    """Where a slice is worth its time: the busiest place, a reversal, an illegal transition."""
    a, b = trace["a"].ticks[1:], trace["b"].ticks[1:]
    edges = np.union1d(a, b)
    if not edges.size:
        return [trace.end // 2]
    span = SLICE_TICKS // 16
    busiest = edges[np.argmax(np.searchsorted(edges, edges + span) - np.arange(edges.size))]
    again = np.sort(np.concatenate([a[1:][~_between(a, b)], b[1:][~_between(b, a)]]))
    illegal = np.intersect1d(a, b)
    return sorted({int(busiest) + span // 2, *again[:1].tolist(), *illegal[:1].tolist()})


def _between(ticks: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Whether the other channel changes between each two successive ticks."""
    return np.diff(np.searchsorted(other, ticks)) > 0


@every_pair
def test_leap_is_pysim_around_the_events_of_every_capture(capture: Path, axis: str) -> None:
    config = Config(sensors=1, filter_ticks=5, stamp_depth=4)
    trace = pins(capture, axis)
    for event in events(trace)[:1]:
        half = SLICE_TICKS // 16 // 2
        start = min(max(event - half, 0), trace.end - 2 * half)
        piece = trace.slice(start, start + 2 * half)
        inputs = stimulus(piece, config, Fraction(1, 1000))
        assert_equal(config, inputs, "leap", "pysim")


SMALL = {
    "clock_hz": 20_000,
    "overspeed_kmh": Fraction(15),
    "count_bits": 8,
    "time_bits": 16,
    "minimum_kmh": Fraction(3),
}
COMPILED = (
    Config(**SMALL, sensors=1, filter_ticks=0, period_bits=8, window_pulses=12, missing_pulses=3),
    Config(**SMALL, sensors=2, filter_ticks=1, period_bits=9, window_pulses=5, stamp_depth=3),
    Config(**SMALL, sensors=1, filter_ticks=7, period_bits=10, window_pulses=1, stamp_depth=16),
    Config(**SMALL, sensors=1, filter_ticks=20, period_bits=8, phase_fault_periods=1),
)


@cache
def opened(kind: str, config: Config) -> tuple[Engine, Any]:
    """An engine that is compiled once, and its state at tick 0."""
    engine = open_engine(design(config), kind)
    return engine, engine.checkpoint()


def rerun(kind: str, config: Config, inputs: Trace) -> Trace:
    engine, start = opened(kind, config)
    engine.restore(start)
    return engine.advance(inputs.end, inputs)


@given(stimuli(of=st.sampled_from(COMPILED)))
@settings(max_examples=300, deadline=None)
def test_leap_is_cxxrtl_under_any_stimulus(drawn: tuple[Config, Trace]) -> None:
    config, inputs = drawn
    leap, gateware = through("leap", config, inputs), rerun("cxxrtl", config, inputs)
    assert leap.first_difference(gateware) is None


@pytest.mark.slow
@given(stimuli(of=st.sampled_from(COMPILED), end=20_000))
@settings(max_examples=20_000, deadline=None)
def test_leap_is_cxxrtl_under_very_many_stimuli(drawn: tuple[Config, Trace]) -> None:
    config, inputs = drawn
    leap, gateware = through("leap", config, inputs), rerun("cxxrtl", config, inputs)
    assert leap.first_difference(gateware) is None


@given(stimuli(end=700))
@settings(max_examples=25, deadline=None)
def test_leap_is_pysim_under_any_stimulus_and_configuration(drawn: tuple[Config, Trace]) -> None:
    config, inputs = drawn
    assert_equal(config, inputs, "leap", "pysim")


@pytest.mark.parametrize("config", COMPILED)
def test_a_read_at_every_tick_about_an_edge_is_the_same_in_each_engine(config: Config) -> None:
    edges = {"sensor.0.a": [0, 100, 160, 220, 280], "sensor.0.b": [0, 130, 190, 250, 310]}
    waves = {name: Waveform.of(at, np.arange(5) & 1) for name, at in edges.items()}
    for read_tick in range(95, 135):
        ticks = [0, read_tick, read_tick + 1, read_tick + 60, read_tick + 61]
        inputs = trace(config, {**waves, "strobe": Waveform.of(ticks, [0, 1, 0, 1, 0])}, 400)
        results = [rerun(kind, config, inputs) for kind in ("cxxrtl", "pysim")]
        leap = through("leap", config, inputs)
        assert all(leap.first_difference(result) is None for result in results)
