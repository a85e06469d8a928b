"""The closed loop is the same in one design and in step functions with the model (SYS-2)."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from position_link.equality import assert_fixed_phase, assert_same, leap, opened
from position_link.plant.stimuli import CONFIGS, SMALL
from railgate.engines import Engine, open_engine
from railgate.position_link.loop import loop
from railgate.position_link.plant import FAULTS, Fault, Scenario, received
from railgate.position_link.spec import EVEN, Config, Status
from railgate.waves import Trace, Waveform

pytestmark = pytest.mark.shows("SYS-2")

LOOPED = Config(**SMALL, check=EVEN, zero_is_fault=True)


@st.composite
def scenarios(draw: st.DrawFn, config: Config, cycles: int) -> Scenario:
    """Any faults; without them the answer is good, however long the cable is."""
    half = config.ticks // (2 * config.bits)
    found = []
    for _ in range(draw(st.integers(0, 6))):
        kind = draw(st.sampled_from(tuple(FAULTS)))
        start = Fraction(draw(st.integers(0, cycles * config.cycle_ticks - 1)), config.clock_hz)
        length = Fraction(draw(st.integers(1, 2 * config.cycle_ticks)), config.clock_hz)
        end = draw(st.sampled_from((None, start + length)))
        low, high = {"stuck": (0, 1), "drift": (-2, half)}.get(kind, (1, config.word_bits))
        value = draw(st.none() | st.integers(low, high)) if FAULTS[kind].value else None
        found.append(Fault(kind, start, end, value))
    return Scenario(
        faults=tuple(found),
        seed=draw(st.integers(0, 9)),
        delay_ticks=draw(st.integers(12, max(half, 13))),
        latency_clk=draw(st.none() | st.integers(config.earliest_clk, config.window_bits)),
    )


def assert_loop_is_the_same(
    scenario: Scenario, config: Config, cycles: int, engine: Engine
) -> Trace:
    """Link, pins and radio unit in one compiled design, and step functions with the model."""
    plan = scenario.plan(config, cycles)
    pins, told = plan.drive(), plan.controls()
    link = leap(config, pins)
    found = engine.advance(told.end, told)
    assert_same(link.merge(pins).merge(received(config, link)), found, config, scenario)
    assert_fixed_phase(config, pins, found)
    return found


@given(st.sampled_from(CONFIGS), st.data())
@settings(max_examples=12, deadline=None)
def test_the_loop_of_pysim_is_that_of_leap_whatever_goes_wrong(
    config: Config, data: st.DataObject
) -> None:
    scenario = data.draw(scenarios(config, 5))
    assert_loop_is_the_same(scenario, config, 5, open_engine(loop(config), "pysim"))


@given(st.data())
@settings(max_examples=120, deadline=None)
def test_the_loop_of_cxxrtl_is_that_of_leap_whatever_goes_wrong(data: st.DataObject) -> None:
    scenario = data.draw(scenarios(LOOPED, 20))
    assert_loop_is_the_same(scenario, LOOPED, 20, opened(loop, "cxxrtl", LOOPED))


@given(st.data(), st.integers(1, 3 * LOOPED.cycle_ticks))
@settings(max_examples=20, deadline=None)
def test_after_a_reset_the_loop_is_that_of_leap_again(data: st.DataObject, at: int) -> None:
    plan = data.draw(scenarios(LOOPED, 4)).plan(LOOPED, 4)
    told, after = plan.controls(), at + 1
    inputs = told.slice(0, after).concatenate(told.shift(after))
    rst = Waveform.of([0, at, after], [0, 1, 0])
    inputs = inputs.merge(Trace({"rst": rst}, inputs.period, 0, inputs.end))
    found = opened(loop, "cxxrtl", LOOPED).advance(inputs.end, inputs)
    link = leap(LOOPED, plan.drive())
    expected = link.merge(plan.drive()).merge(received(LOOPED, link))
    assert_same(expected.slice(0, after), found.slice(0, after), at)
    assert_same(expected.shift(after), found.slice(after, found.end), at)


def test_the_loop_is_the_same_for_longer_than_a_frame_can_number() -> None:
    cycles = 600
    faults = [
        Fault(kind, (20 * n + 20) * LOOPED.cycle_s, value=2 if kind == "drift" else None)
        for n, kind in enumerate(FAULTS)
    ]
    engine = opened(loop, "cxxrtl", LOOPED)
    found = assert_loop_is_the_same(Scenario(faults=tuple(faults)), LOOPED, cycles, engine)
    assert found["radio.number"].falling().size == cycles // 256
    assert found["radio.frames"].values[-1] == cycles


@pytest.mark.parametrize("clock_mhz", [40, 48, 50, 100, 125])
def test_the_loop_is_the_same_at_every_clock(clock_mhz: int) -> None:
    config = replace(Config(), clock_hz=clock_mhz * 1_000_000)
    faults = (Fault("missing", config.cycle_s), Fault("glitch", 3 * config.cycle_s))
    engine = opened(loop, "cxxrtl", config)
    found = assert_loop_is_the_same(Scenario(faults=faults), config, 4, engine)
    status = found["status"].values.tolist()
    assert status == [Status.FAULT, Status.FRESH, Status.HELD, Status.FRESH]
    assert len(found["clk"]) == 1 + 2 * 4 * 10_240


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_the_loop_is_the_same_for_long_with_random_faults(seed: int) -> None:
    config, cycles = Config(), 65
    random = np.random.default_rng(seed)
    faults = [
        Fault(kind, Fraction(int(random.integers(cycles * 20_000 - 1)), 10**6))
        for kind in FAULTS
        for _ in range(random.integers(1, 3))
    ]
    scenario = Scenario(faults=tuple(faults), seed=seed, delay_ticks=int(random.integers(70)))
    found = assert_loop_is_the_same(scenario, config, cycles, opened(loop, "cxxrtl", config))
    assert found.end > 5 * 10**7
    assert found["radio.faults"].values.tolist() == [0]
