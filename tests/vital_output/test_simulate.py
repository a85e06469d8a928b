"""A run of both channels: the same in each engine, whatever it is told about its progress."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from railgate.vital_output.plant.faults import fault
from railgate.vital_output.plant.scenario import Scenario
from railgate.vital_output.simulate import COUNTS, simulate
from railgate.vital_output.spec import CAUSES
from vital_output.runs import run_of, scenario_of
from vital_output.small import SMALL

CYCLE = SMALL.cycle_s
PINS = {f"fpga_{fpga}.{name}" for fpga in (1, 2) for name in ("pulses", "link_tx")}


def short() -> Scenario:
    """To the drive and back, with a frame that is rejected and an FPGA that starts anew."""
    scenario = scenario_of("good")
    first = replace(scenario.commands[0], start_s=5 * CYCLE)
    faults = (fault("repetition-1@90ms"), fault("restart-2@100ms"))
    return replace(scenario, commands=(first,), seconds=11 * CYCLE, faults=faults)


@pytest.mark.shows("SYS-2")
def test_leap_and_the_compiled_closed_loop_make_the_same_run() -> None:
    leap, compiled = (simulate(short(), SMALL, engine) for engine in ("leap", "cxxrtl"))
    assert leap.trace.first_difference(compiled.trace) is None
    assert leap.as_json() == {**compiled.as_json(), "engine": "leap"}
    assert leap.as_json()["fpga_1"]["repetition"] == 1


@pytest.mark.parametrize("span", [None, (Fraction(0), CYCLE), (7 * CYCLE, 99 * CYCLE)])
def test_progress_is_told_and_changes_nothing(span: tuple[Fraction, Fraction] | None) -> None:
    told: list[float] = []
    watched = simulate(short(), SMALL, progress=told.append, waves_s=span)
    alone = simulate(short(), SMALL, waves_s=span)
    assert watched.trace.first_difference(alone.trace) is None
    assert watched.waves.first_difference(alone.waves) is None
    assert len(told) >= 100
    assert told == sorted(told)
    assert told[-1] == 1


def test_pulses_and_cross_link_are_kept_of_the_part_that_is_asked_for() -> None:
    span = (7 * CYCLE, 8 * CYCLE)
    run = simulate(short(), SMALL, waves_s=span)
    assert (run.waves.start, run.waves.end) == tuple(int(t * 10**15) for t in span)
    assert run.waves.signals.keys() == run.trace.signals.keys() | PINS
    assert not PINS & run.trace.signals.keys()
    same = run.waves.select(run.trace.signals)
    assert run.trace.slice(run.waves.start, run.waves.end).first_difference(same) is None
    rises = run.waves["fpga_1.pulses"].rising().size
    assert rises == pytest.approx(float(CYCLE) * SMALL.pulse_hz, abs=2)
    assert run.trace.first_difference(simulate(short(), SMALL).trace) is None


def test_without_a_part_the_waves_are_the_whole_run() -> None:
    run = run_of("good")
    assert run.waves is run.trace
    assert (run.trace.start, run.trace.end) == (0, int(run.scenario.seconds * 10**15))


def test_waves_that_begin_after_the_run_are_refused() -> None:
    with pytest.raises(ValueError, match=r"inside the run of 0\.132 s, not at 9 s"):
        simulate(short(), SMALL, waves_s=(Fraction(9), Fraction(10)))


def test_figures_are_counted_over_resets() -> None:
    told = run_of("channel-restart").as_json()
    assert list(told["fpga_1"]) == list(COUNTS)
    assert set(COUNTS) > {cause.name.lower() for cause in CAUSES}
    assert told["fpga_1"]["start"] == 2
    assert told["fpga_2"]["start"] == 1
    assert told["fpga_2"]["accepted"] == told["fpga_1"]["accepted"] + 3


def test_times_of_the_reaction_are_told_beside_the_declared_one() -> None:
    told = run_of("cpu-dead").as_json()
    assert told["declared_reaction_s"] == float(SMALL.reaction_s)
    (closing,) = told["closings"]
    assert told["worst_reaction_s"] == closing["since_live_s"]
    assert told["worst_commanded_s"] is None
    assert closing["opened_s"] - closing["live_s"] == pytest.approx(closing["since_live_s"])
    good = run_of("good").as_json()
    assert good["worst_reaction_s"] is None
    assert CYCLE < good["worst_commanded_s"] < good["declared_reaction_s"]
