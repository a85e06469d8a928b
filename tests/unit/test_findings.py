"""Faults and what told of them; premises that a scenario breaks; the spans that are kept."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from railgate.unit.conditions import broken
from railgate.unit.events import Event
from railgate.unit.excerpts import AFTER_S, BEFORE_S, TOTAL_S, excerpts
from railgate.unit.faults import Fault
from railgate.unit.findings import injected
from railgate.unit.result import Result
from railgate.unit.scenario import Scenario

END_S = Fraction(100)


@pytest.fixture
def sound(result: Result) -> Scenario:
    """Without faults, and with clocks in tolerance."""
    return replace(result.run.scenario, faults=())


def wheel(kind: str, axle: int, start_s: int, end_s: int | None = None) -> Fault:
    end = None if end_s is None else Fraction(end_s)
    return Fault(part="wheel", kind=kind, axle=axle, start_s=Fraction(start_s), end_s=end)


def test_each_fault_has_what_its_part_of_the_unit_told_next(result: Result) -> None:
    link, _, cpu = result.injected
    assert (link.what, link.start_s, link.end_s) == ("position link: missing", 9.0, 9.2)
    assert [found.what for found in link.found] == ["warning: timeout", "alarm: timeout"]
    assert all(found.source == "position link" for found in link.found)
    assert 0 <= link.found[0].delay_s < 0.02
    assert (cpu.what, cpu.end_s) == ("cpu 1 dead", None)
    first = {found.source: found for found in reversed(cpu.found)}
    assert first.keys() == {"FPGA 1", "FPGA 2", "relay"}
    assert first["FPGA 1"].what.startswith("vote failed")
    assert first["relay"].what.startswith("output 0: contact opens")
    assert first["relay"].delay_s < result.verdict.declared_s


def test_what_another_part_tells_or_tells_before_is_no_finding(sound: Scenario) -> None:
    scenario = replace(sound, faults=(wheel("slip", 2, 10, 12),))
    events = [
        Event(9.9, "odometer 1", "axle 2: slips", 1.0, 1.0),
        Event(10.1, "odometer 1", "axle 1: slips", 1.0, 1.0),
        Event(10.2, "FPGA 1", "axle 2: slips", 1.0, 1.0),
        Event(10.3, "odometer 2", "axle 2: slips", 1.0, 1.0),
        Event(13.5, "odometer 1", "axle 2: slips", 1.0, 1.0),
    ]
    (fault,) = injected(scenario, events)
    assert [(each.source, each.delay_s) for each in fault.found] == [
        ("odometer 2", pytest.approx(0.3))
    ]
    assert injected(scenario, [])[0].found == ()


def test_a_clock_off_its_tolerance_is_a_fault_from_the_begin(sound: Scenario) -> None:
    assert injected(sound, []) == ()
    event = Event(0.107, "FPGA 2", "clock of FPGA 1 off its tolerance", 0.0, 0.0)
    (fault,) = injected(replace(sound, ppm_1=Fraction(300)), [event])
    assert fault.what == "clock of FPGA 1: +300 ppm"
    assert fault.found[0].delay_s == 0.107


def test_a_scenario_that_keeps_the_premises_breaks_none(sound: Scenario) -> None:
    assert broken(sound) == ()


def test_premises_that_are_broken_are_named(sound: Scenario) -> None:
    sensor = replace(sound.sensor, tooth_error=0.1, jitter_s=1e-3, dropouts=0.01)
    route = replace(sound.route, braking_m_s2=2.0)
    bad = replace(sound, ppm_2=Fraction(-250), sensor=sensor, route=route)
    told = broken(bad)
    for number, word in enumerate(("clock", "pitch", "ticks late", "lost or false", "m/s²")):
        assert word in told[number]
    assert len(told) == 5
    assert "FPGA 2's is -250 ppm off" in told[0]


def test_one_axle_that_does_not_roll_breaks_no_premise_but_two_at_once_do(
    sound: Scenario,
) -> None:
    one, later, meanwhile = (
        wheel("locked", 1, 10, 12),
        wheel("slide", 2, 15, 16),
        wheel("slide", 2, 11, 14),
    )
    assert broken(replace(sound, faults=(one, later))) == ()
    assert broken(replace(sound, faults=(one, wheel("slide", 1, 11, 14)))) == ()
    (told,) = broken(replace(sound, faults=(one, meanwhile)))
    assert told == "an axle that rolls and is measured: from 11 s on there is none"
    (lost,) = broken(replace(sound, faults=(wheel("a-lost", 2, 10),)))
    assert lost == "no edge lost or false: axle 2, a lost from 10 s on"


def test_near_events_share_an_excerpt_and_far_ones_do_not() -> None:
    found = excerpts([0.01, 5.0, 5.1, 9.0, 99.99], END_S)
    assert found.of == (0, 1, 1, 2, 3)
    first, near, _, last = found.spans
    assert first == (0, pytest.approx(0.01 + float(AFTER_S)))
    assert near == (pytest.approx(5 - float(BEFORE_S)), pytest.approx(5.1 + float(AFTER_S)))
    assert last[1] == END_S
    assert found.name(0) == "001"


def test_many_events_make_many_excerpts_apart_from_one_another_each_with_its_events() -> None:
    times = [n * 0.05 for n in range(400)]
    found = excerpts(times, END_S)
    assert len(found.spans) > 5
    for (_, end), (start, _) in zip(found.spans, found.spans[1:], strict=False):
        assert end < start
    for time_s, number in zip(times, found.of, strict=True):
        assert number is not None
        start, end = found.spans[number]
        assert start <= Fraction(time_s) <= end


def test_a_run_of_nothing_but_events_is_not_kept_as_a_whole() -> None:
    found = excerpts([n * 0.1 for n in range(1000)], END_S)
    assert found.of[0] == 0
    assert found.of[-1] is None
    assert TOTAL_S <= sum(end - start for start, end in found.spans) < TOTAL_S + 3
