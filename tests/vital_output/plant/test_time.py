"""The time port: when updates come, and what time they give."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.vital_output.plant.scenario import Scenario
from vital_output.plant.received import CYCLES, edges, sampled, scenario
from vital_output.small import SMALL

CYCLE = SMALL.cycle_ticks

Given = list[tuple[int, int, int]]


def given_times(told: Scenario, fpga: int) -> Given:
    """The tick of each update, and its index and phase."""
    inputs = told.controls(SMALL)
    rows = sampled(told, inputs, fpga, "time.index", "time.phase", "time.valid")
    return [
        (tick, index, phase)
        for tick, (index, phase, valid) in enumerate(zip(*rows, strict=True))
        if valid
    ]


def off_ticks(told: Scenario, fpga: int) -> list[Fraction]:
    """By how much each update is ahead of the network's time when its tick begins."""
    clock = edges(told, fpga)
    return [
        ((index - told.first_index) * CYCLE + phase)
        - (tick + clock.clock.phase) * clock.clock.period * SMALL.clock_hz
        for tick, index, phase in given_times(told, fpga)
    ]


clocks = st.fractions(-200, 200, max_denominator=100)
phases = st.fractions(0, Fraction(49, 50), max_denominator=50)


@given(clocks, clocks, phases, phases)
@settings(max_examples=8, deadline=None)
def test_an_update_is_the_networks_time_of_its_tick_whatever_the_clock(
    ppm_1: Fraction, ppm_2: Fraction, phase_1: Fraction, phase_2: Fraction
) -> None:
    told = scenario(ppm_1=ppm_1, ppm_2=ppm_2, phase_1=phase_1, phase_2=phase_2, first_index=7)
    for fpga in (1, 2):
        assert len(given_times(told, fpga)) == CYCLES
        assert all(abs(off) <= Fraction(1, 2) for off in off_ticks(told, fpga))


def test_with_the_networks_own_clock_the_phase_is_the_tick() -> None:
    found = given_times(scenario(phase_1=Fraction(0)), 1)
    middle = CYCLE // 2
    assert found == [(c * CYCLE + middle, c, middle) for c in range(CYCLES)]


def test_updates_come_as_often_as_told() -> None:
    assert [index for _, index, _ in given_times(scenario(update_cycles=5), 2)] == [0, 5, 10]


def test_the_index_wraps() -> None:
    told = scenario(first_index=(1 << 32) - 2)
    assert [index for _, index, _ in given_times(told, 1)][:4] == [2**32 - 2, 2**32 - 1, 0, 1]


def test_values_change_with_the_edges() -> None:
    told = scenario(ppm_2=Fraction(-99), phase_2=Fraction(1, 7))
    inputs, clock = told.controls(SMALL), edges(told, 2)
    for name in ("index", "phase", "valid"):
        ticks = inputs[f"fpga_2.time.{name}"].ticks
        assert (clock.begin(clock.during(ticks)) == ticks).all()


@pytest.mark.parametrize("fpga", [1, 2])
def test_lost_time_is_that_of_the_span_and_of_the_one_fpga(fpga: int) -> None:
    told = scenario(f"time-lost-{fpga}@37ms..60ms")
    assert [index for _, index, _ in given_times(told, fpga)] == [0, 1, 2, *range(5, CYCLES)]
    assert len(given_times(told, 3 - fpga)) == CYCLES
    for_ever = scenario(f"time-lost-{fpga}@37ms")
    assert [index for _, index, _ in given_times(for_ever, fpga)] == [0, 1, 2]


@pytest.mark.parametrize(
    ("text", "ticks"),
    [("time-step-1@36ms", CYCLE), ("time-step-1:250@36ms", 250), ("time-step-1:-7@36ms", -7)],
)
def test_a_step_puts_time_ahead_from_then_on(text: str, ticks: int) -> None:
    told = scenario(text)
    assert np.rint(np.array(off_ticks(told, 1), float)).tolist() == [0] * 3 + [ticks] * 9
    assert set(np.rint(np.array(off_ticks(told, 2), float))) == {0}


@pytest.mark.parametrize(("text", "ppm"), [("time-drift-2", 1000), ("time-drift-2:-500", -500)])
def test_drifting_time_runs_fast_and_is_right_again_after_the_span(text: str, ppm: int) -> None:
    told = scenario(f"{text}@24ms..60ms")
    step = CYCLE * ppm / 1e6
    found = np.array(off_ticks(told, 2), float)
    expected = [0, 0, step / 2, step * 3 / 2, step * 5 / 2] + [0] * 7
    assert np.abs(found - expected).max() <= 1.01
