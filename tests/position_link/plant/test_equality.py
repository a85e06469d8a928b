"""Step functions and gateware of the plant are the same, tick for tick (SYS-2)."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from position_link.plant.stimuli import (
    CONFIGS,
    clock_lines,
    levels,
    plans,
    scenarios,
    through,
)
from railgate.position_link.plant import FAULTS, Fault, Plan, Scenario, received
from railgate.position_link.spec import Config
from railgate.waves import Trace, Waveform

DEFAULT = Config()


def assert_same_pins(kind: str, told: Plan) -> Trace:
    inputs = told.controls().merge(clock_lines(told.config, told.cycles))
    found = through(kind, told.config, inputs).select(["uef", "data"])
    difference = told.drive().first_difference(found)
    assert difference is None, f"steps and {kind} part: {difference}"
    return found


@given(st.sampled_from(CONFIGS).flatmap(plans))
@settings(max_examples=200, deadline=None)
def test_the_pins_are_those_of_cxxrtl_whatever_is_told(told: Plan) -> None:
    assert_same_pins("cxxrtl", told)


@given(st.sampled_from(CONFIGS).flatmap(lambda config: plans(config, 2)))
@settings(max_examples=12, deadline=None)
def test_the_pins_are_those_of_pysim_whatever_is_told(told: Plan) -> None:
    assert_same_pins("pysim", told)


@given(st.sampled_from(CONFIGS), st.data())
@settings(max_examples=100, deadline=None)
def test_the_pins_are_the_same_in_any_scenario(config: Config, data: st.DataObject) -> None:
    assert_same_pins("cxxrtl", data.draw(scenarios(config, 4)).plan(config, 4))


def test_the_pins_are_the_same_with_every_fault_at_full_size() -> None:
    cycle_s = DEFAULT.cycle_s
    every = [Fault(kind, (2 * i + 1) * cycle_s) for i, kind in enumerate(FAULTS)]
    told = Scenario(faults=tuple(every)).plan(DEFAULT, 2 * len(every) + 1)
    found = assert_same_pins("cxxrtl", told)
    assert len(found["uef"]) > 2 * told.cycles


@pytest.mark.parametrize("config", CONFIGS)
def test_without_another_request_there_is_no_other_answer(config: Config) -> None:
    told = Scenario(latency_clk=config.cycle_bits).plan(config, 3)
    lines = clock_lines(config, 3)
    anf = {**lines.signals, "anf": lines["anf"].slice(0, config.cycle_ticks)}
    inputs = told.controls().merge(Trace(anf, lines.period, 0, lines.end))
    uef = through("cxxrtl", config, inputs)["uef"]
    assert uef == told.drive()["uef"].slice(0, 2 * config.cycle_ticks - 100)
    assert len(uef) == 3


def serial(config: Config, frames: list[list[int]], gaps: list[int]) -> Trace:
    """A radio line: frames of these bits launched with rising CLK, so many CLK between."""
    valid, data = [0], [0]
    for bits, gap in zip(frames, gaps, strict=True):
        valid += [0] * gap + [1] * len(bits)
        data += [0] * gap + bits
    ticks = [0]
    for n in range(len(valid)):
        c, period = divmod(n, config.cycle_bits)
        ticks.append(1 + c * config.cycle_ticks + config.rise(period))
    end = 1 + 6 * config.cycle_ticks
    signals = {
        "radio_valid": Waveform.of(ticks, [*valid, 0]).slice(0, end),
        "radio_data": Waveform.of(ticks, [*data, 0]).slice(0, end),
    }
    return Trace(signals, Fraction(1, config.clock_hz), 0, end)


def frame(config: Config, payload: int) -> list[int]:
    """The bits of a frame with a right check."""
    if config.bare:
        return [payload >> i & 1 for i in reversed(range(config.frame_bits))]
    width = config.radio_check.width
    count = config.frame_bits - width
    payload &= (1 << count) - 1
    whole = payload << width | config.radio_check.of(payload, count)
    return [whole >> i & 1 for i in reversed(range(config.frame_bits))]


@st.composite
def radio_lines(draw: st.DrawFn) -> tuple[Config, Trace]:
    """Right frames, those with a wrong bit, and those too short or too long; any gaps."""
    config = draw(st.sampled_from(CONFIGS))
    frames, gaps = [], []
    for _ in range(draw(st.integers(0, 4))):
        bits = frame(config, draw(st.integers(0, (1 << config.frame_bits) - 1)))
        what = draw(st.sampled_from(("right", "right", "wrong", "long", "short")))
        at = draw(st.integers(0, len(bits) - 1))
        bits[at] ^= what == "wrong"
        bits = bits + [1] * draw(st.integers(1, 9)) if what == "long" else bits
        frames.append(bits[: at + 1] if what == "short" else bits)
        gaps.append(draw(st.integers(0, 40)))
    return config, serial(config, frames, gaps)


def assert_same_reception(kind: str, config: Config, line: Trace) -> None:
    found = through(kind, config, line.merge(clock_lines(config, 6)))
    expected = received(config, line)
    difference = expected.first_difference(found.select(expected.signals))
    assert difference is None, f"steps and {kind} part: {difference}"


@given(radio_lines())
@settings(max_examples=100, deadline=None)
def test_the_radio_unit_is_that_of_cxxrtl_on_any_frames(drawn: tuple[Config, Trace]) -> None:
    assert_same_reception("cxxrtl", *drawn)


@given(
    st.sampled_from(CONFIGS),
    *[st.lists(st.integers(1, 1500), unique=True, max_size=30) for _ in range(2)],
)
@settings(max_examples=50, deadline=None)
def test_the_radio_unit_is_that_of_cxxrtl_on_any_levels(
    config: Config, valid: list[int], data: list[int]
) -> None:
    waves = {"radio_valid": levels(valid), "radio_data": levels(data)}
    end = 1 + 6 * config.cycle_ticks
    assert_same_reception("cxxrtl", config, Trace(waves, Fraction(1, config.clock_hz), 0, end))


@pytest.mark.parametrize("config", CONFIGS)
def test_the_radio_unit_is_that_of_pysim(config: Config) -> None:
    frames = [frame(config, 0x5A96 * 3**i) for i in range(3)]
    frames[1][3] ^= 1
    line = serial(config, frames, [3, 1, 5])
    assert_same_reception("pysim", config, line)
    told = received(config, line)
    assert told["radio.frames"].values[-1] == (3 if config.bare else 2)
    assert told["radio.faults"].values[-1] == (0 if config.bare else 1)


def test_what_is_received_until_a_tick_does_not_depend_on_what_comes_after() -> None:
    config = CONFIGS[0]
    line = serial(config, [frame(config, 0x2A5C)], [3])
    whole = received(config, line)
    change = int(whole["radio.frames"].ticks[1])
    for end in (1, 50, *range(change - 12, change + 3)):
        assert received(config, line.slice(0, end)) == whole.slice(0, end)


def test_after_a_reset_all_is_as_at_start() -> None:
    config = CONFIGS[0]
    told = Scenario(delay_ticks=150, latency_clk=1).plan(config, 2)
    at = 900  # with UEF in the cable, where the second start reads first
    inputs = told.controls().merge(clock_lines(config, 2))
    again = inputs.shift(at + 1)
    first, rst = inputs.slice(0, at + 1), Waveform.of([0, at, at + 1], [0, 1, 0])
    driven = first.concatenate(again)
    driven = Trace({**driven.signals, "rst": rst}, driven.period, 0, driven.end)
    found = through("cxxrtl", config, driven).select(["uef", "data"])
    assert found.slice(at + 1, driven.end).shift(-at - 1) == told.drive()
    assert np.any(found["uef"].ticks > at)
