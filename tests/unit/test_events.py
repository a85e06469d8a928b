"""What is told of a run: each event once, at its time, with speed and place (SYS-6)."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from railgate.unit.result import Result


def told(result: Result, source: str, begin: str) -> list[float]:
    """When this source told of something that begins so."""
    return [e.time_s for e in result.events if (e.source, e.what[: len(begin)]) == (source, begin)]


def test_events_are_in_order_of_time(result: Result) -> None:
    assert all(one.time_s <= other.time_s for one, other in pairwise(result.events))
    assert result.events[0].time_s >= 0
    assert result.events[-1].time_s <= result.run.scenario.seconds


@pytest.mark.shows("SYS-6")
def test_each_event_has_the_speed_and_the_place_of_the_system_cycle_before_it(
    result: Result,
) -> None:
    cycles = result.run.cycles
    for event in result.events:
        before = np.flatnonzero(cycles.times_s <= event.time_s)
        if not before.size:
            assert (event.speed_kmh, event.place_m) == (None, None)
            continue
        assert event.speed_kmh == cycles.measured_kmh[before[-1], 0]
        assert event.place_m == pytest.approx(cycles.place_m[before[-1]], abs=2)


def test_calls_at_platforms_and_faults_are_told_at_their_times(result: Result) -> None:
    first, second = result.run.scenario.route.calls
    assert told(result, "train", "leaves the platform at 50 m") == [first.departs_s]
    assert told(result, "train", "stops at the platform at 150 m") == [second.arrives_s]
    assert told(result, "fault", "position link missing") == [9.0, 9.2]
    assert told(result, "fault", "axle 2 locked") == [12.0, 16.0]
    assert told(result, "fault", "cpu-1-dead") == [30.0]


def test_the_links_health_is_told_as_it_changes(result: Result) -> None:
    """In whole cycles of 20 ms: at the end of a fault's first one, of its third, of the first good
    one."""
    for begin, least, most in (("warning", 8.99, 9.02), ("alarm", 9.03, 9.06), ("ok", 9.19, 9.24)):
        (time_s,) = [t for t in told(result, "position link", begin) if t > 1]
        assert least <= time_s < most


def test_what_goes_on_cycle_after_cycle_is_told_once(result: Result) -> None:
    for fpga in ("FPGA 1", "FPGA 2"):
        (time_s,) = told(result, fpga, "vote failed")
        assert 30 <= time_s < 30.1


def test_routine_is_not_told(result: Result) -> None:
    routine = ("vote passed", "stored", "accepted")
    assert not [e for e in result.events for word in routine if e.what.endswith(word)]


def test_standstill_and_the_doors_are_told_in_the_order_of_cause_and_effect(
    result: Result,
) -> None:
    arrives_s = result.run.scenario.route.calls[1].arrives_s
    times = [
        next(time_s for time_s in told(result, source, what) if time_s > 15)
        for source, what in (
            ("train", "stops"),
            ("odometer 1", "standstill"),
            ("CPUs", "command image 0x1"),
            ("FPGA 1", "output 0: pre-drive → drive"),
            ("relay", "output 0: contact closes"),
            ("fault", "cpu-1-dead"),
            ("relay", "output 0: contact opens"),
        )
    ]
    assert times[0] == arrives_s
    assert times == sorted(times)
