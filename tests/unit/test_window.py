"""Windows of a run in RTL: the same outputs, tick for tick, as the model's."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import cache

import pytest

from railgate.position_link.gateware import PositionLink
from railgate.unit.faults import Fault
from railgate.unit.route import Route, Side, Stop
from railgate.unit.run import Run, run
from railgate.unit.scenario import Scenario
from railgate.unit.scenario_file import builtin, builtins
from railgate.unit.window import Case, cases, compared, replay, replayable
from railgate.vital_output.situations import ready_s

SHORT = Scenario(
    name="short",
    route=Route(
        stops=[Stop(at_m=0, side=Side.RIGHT, dwell_s=8), Stop(at_m=40, dwell_s=7)], speed_kmh=30
    ),
    ppm_1=Fraction(100),
    ppm_2=Fraction(-100),
    faults=(
        Fault(part="link", kind="missing", start_s=Fraction(21, 1000)),
        Fault(part="vital", kind="cpu-2-dead", start_s=Fraction(3), end_s=Fraction(7, 2)),
    ),
)
WINDOWS = 10


@cache
def ran() -> Run:
    return run(SHORT)


def of(span: tuple[Fraction, Fraction], function: str) -> Case:
    (found,) = (case for case in cases(ran(), span) if case.function == function)
    return found


def test_a_window_at_the_start_is_the_run_itself_in_rtl() -> None:
    found = list(replay(ran(), (Fraction(0), Fraction(3, 100)), "cxxrtl"))
    assert [each.difference for each in found] == [None] * 4
    assert {each.warm_s for each in found} == {Fraction(0)}
    assert found[0].ticks == 480_048


def test_a_difference_is_told() -> None:
    """RTL of a link that waits longer than the model's for its answer."""
    case = of((Fraction(0), Fraction(3, 100)), "position link")
    patient = replace(SHORT.config.link, timeout_bits=SHORT.config.link.timeout_bits + 1)
    other = replace(case.design, component=lambda: PositionLink(patient))
    found = compared(replace(case, design=other), "cxxrtl")
    assert found.difference is not None
    assert "tick" in found.difference


def test_the_vital_output_is_warmed_up_with_what_the_run_had() -> None:
    config = SHORT.config.vital
    case = of((Fraction(3), Fraction(31, 10)), "vital output")
    assert case.warm_s <= 3 - ready_s(config)
    assert case.warm_s % config.cycle_s == 0
    whole = ran().vital.scenario.controls(config)
    shift = int(case.warm_s * 10**15)
    for name in ("fpga_1.command.payload", "fpga_2.command.payload", "fpga_1.time.index"):
        start = shift + int(ready_s(config) * 10**15)
        there = whole[name].slice(start, shift + case.stimulus.end).shift(-shift)
        assert case.stimulus[name].slice(start - shift, case.stimulus.end) == there


@pytest.mark.parametrize("span", [(-1, 1), (1, 1), (0, 100)])
def test_a_window_outside_the_run_is_refused(span: tuple[int, int]) -> None:
    with pytest.raises(ValueError, match="a window must lie inside the run"):
        replayable(SHORT, (Fraction(span[0]), Fraction(span[1])), "cxxrtl")


@pytest.mark.slow
@pytest.mark.shows("SYS-2", kind="sweep")
@pytest.mark.parametrize("name", builtins())
def test_ten_windows_of_every_built_in_scenario_are_the_same_in_rtl(name: str) -> None:
    """Spread over the run, the last one at its end."""
    found = run(builtin(name))
    last = found.scenario.seconds - Fraction(1, 10)
    for n in range(WINDOWS):
        start = last * n / (WINDOWS - 1)
        for each in replay(found, (start, start + Fraction(1, 10)), "cxxrtl"):
            assert each.difference is None, (name, float(start), each)
