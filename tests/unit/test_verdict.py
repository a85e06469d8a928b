"""Whether a run was safe, on contacts that are closed by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from railgate.unit.result import Result
from railgate.unit.route import Side
from railgate.unit.run import Run
from railgate.unit.verdict import judge
from railgate.waves import Trace, Waveform

DECLARED_S = 0.2587


def with_contact(run: Run, *spans: tuple[Side, float, float]) -> Run:
    """The run, but its contacts were closed in these spans, and in these only."""
    turns = sorted({0.0, *(time for _, start, end in spans for time in (start, end))})
    values = [
        sum({1 << side.value for side, start, end in spans if start <= time < end})
        for time in turns
    ]
    ticks = np.round(np.array(turns) * 1e15).astype(np.int64)
    trace = run.vital.trace
    signals = {**trace.signals, "contact": Waveform.of(ticks, values, 2)}
    told = Trace(signals, trace.period, trace.start, trace.end)
    return replace(run, vital=replace(run.vital, trace=told))


@pytest.fixture
def run(result: Result) -> Run:
    return result.run


@pytest.mark.shows("DRV-16")
def test_a_run_whose_unit_reacts_in_time_is_safe(result: Result) -> None:
    assert result.verdict.safe
    assert result.verdict.reasons == ()
    assert float(result.verdict.declared_s) == pytest.approx(DECLARED_S, abs=1e-3)


def test_doors_released_in_motion_for_longer_than_declared_are_not_safe(run: Run) -> None:
    for lasts_s, safe in ((0.25, True), (0.27, False)):
        verdict = judge(with_contact(run, (Side.LEFT, 14.0, 14.0 + lasts_s)))
        assert bool(verdict.wrong) != safe
    assert not verdict.safe
    (reason,) = [each for each in verdict.reasons if "released" in each]
    assert reason == "left doors released in motion for 0.270 s from 14.000 s on"


def test_doors_still_released_when_the_train_leaves_are_held_to_the_same_time(run: Run) -> None:
    departs_s = run.scenario.route.calls[0].departs_s
    for late_s, safe in ((0.25, True), (0.27, False)):
        verdict = judge(with_contact(run, (Side.RIGHT, 3.0, departs_s + late_s)))
        assert bool(verdict.wrong) != safe
    (release,) = verdict.wrong
    assert (release.start_s, release.where) == (departs_s, "in motion")


def test_doors_released_on_the_wrong_side_of_the_platform_are_not_safe(run: Run) -> None:
    (release,) = judge(with_contact(run, (Side.LEFT, 2.0, 6.0))).wrong
    assert release.where == "on the wrong side at 50 m"
    assert (release.start_s, release.end_s) == (2.0, 6.0)


def test_doors_released_from_one_platform_to_the_other_are_told_with_all_that_is_wrong(
    run: Run,
) -> None:
    here, there = run.scenario.route.calls
    end_s = there.arrives_s + 3
    (release,) = judge(with_contact(run, (Side.RIGHT, 3.0, end_s))).wrong
    assert release.where == "in motion and on the wrong side at 150 m"
    assert (release.start_s, release.end_s) == (here.departs_s, pytest.approx(end_s))


@pytest.mark.shows("DRV-16")
def test_a_contact_that_stays_closed_without_a_live_command_is_not_safe(run: Run) -> None:
    """At the right platform and side, but nobody commands it any more."""
    arrives_s = run.scenario.route.calls[1].arrives_s
    end_s = float(run.scenario.seconds) - 0.1
    verdict = judge(with_contact(run, (Side.LEFT, arrives_s + 3, end_s)))
    assert not verdict.wrong
    assert not verdict.safe
    assert "left doors: the contact stayed closed" in verdict.reasons[0]
