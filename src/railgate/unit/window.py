"""A part of a run once more, in RTL and in the model, from the run's own inputs (SYS-2).

Gateware is too slow for a whole run, so it is warmed up: each function starts by a reset some time
before the window, with what came to its pins from then on, in both engines, and all of its outputs
must be the same in every tick from there to the window's end. Two things differ from the run, where
a window does not begin with it: counters and times count from the later start, and until its
start-up test is over the vital output is commanded 0, as it is after every start, so that outputs
which are on drive again before the window.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from math import floor

from railgate.engines import Clock, Design, Engine, open_engine
from railgate.odometer.design import design as odometer_design
from railgate.position_link.design import design as link_design
from railgate.unit.run import Run
from railgate.unit.scenario import Scenario
from railgate.unit.sensing import rate
from railgate.vital_output.loop import loop
from railgate.vital_output.plant import FAULTS, Command, Fault
from railgate.vital_output.plant import Scenario as VitalScenario
from railgate.vital_output.situations import ready_s
from railgate.vital_output.spec import Config as VitalConfig
from railgate.waves import Trace

__all__ = ["Case", "Replayed", "cases", "compared", "replay", "replayable"]

SENSOR_LEAD_S = Fraction(1, 4)
"""The odometer's: some windows between strobes."""
LINK_LEAD_CYCLES = 4
"""More than bring the link up or down."""
VITAL_LEAD_CYCLES = 4
"""Until outputs that are on drive, and their contacts have closed."""
PARTS = 50
"""So often progress is told."""

Span = tuple[Fraction, Fraction]
"""Seconds since the run's start."""


@dataclass(frozen=True)
class Replayed:
    """One function in one window. warm_s: when it was started, since the run's start. ticks: of its
    clocks that were compared. difference: where the engines differ first, None: nowhere."""

    function: str
    warm_s: Fraction
    ticks: int
    difference: str | None


@dataclass(frozen=True)
class Case:
    """A function from its start on. design, stimulus: with tick 0 there. warm_s: when that is."""

    function: str
    design: Design
    stimulus: Trace
    warm_s: Fraction
    ticks: int


def replayable(scenario: Scenario, span: Span, engine: str) -> Span:
    """The span itself. Raises ValueError unless it is inside the run and the engine RTL."""
    start, end = span
    if not 0 <= start < end <= scenario.seconds:
        raise ValueError(
            f"a window must lie inside the run, 0 s..{float(scenario.seconds):g} s, "
            f"not {float(start):g} s..{float(end):g} s"
        )
    if engine == "leap":
        raise ValueError("a window must be replayed on --engine cxxrtl or pysim, not on leap")
    return span


def replay(
    run: Run, span: Span, engine: str, progress: Callable[[str], None] | None = None
) -> Iterator[Replayed]:
    """All functions in a window of the run, on this engine and on leap. Raises ValueError.

    progress: is told of each function and the part done.
    """
    for case in cases(run, replayable(run.scenario, span, engine)):
        yield compared(case, engine, progress)


def compared(case: Case, engine: str, progress: Callable[[str], None] | None = None) -> Replayed:
    """One function on leap and on another engine, to its end or to the first difference."""
    engines: tuple[Engine, ...] = (
        open_engine(case.design, "leap"),
        open_engine(case.design, engine),
    )
    end = case.stimulus.end
    ends = [-(-end * n // PARTS) for n in range(1, PARTS + 1)]
    difference = None
    for n, until in enumerate(ends, 1):
        leap, other = (each.advance(until, case.stimulus) for each in engines)
        difference = leap.first_difference(other)
        if progress:
            progress(f"{case.function} on {engine}, {100 * n // PARTS} %")
        if difference is not None:
            break
    return Replayed(
        case.function, case.warm_s, case.ticks, None if difference is None else str(difference)
    )


def cases(run: Run, span: Span) -> Iterator[Case]:
    """Every function warmed up for a window of the run: both odometers, the link, both channels."""
    unit, scenario = run.scenario.config, run.scenario
    for fpga, odometer in enumerate(run.odometers, 1):
        hz = unit.odometer.clock_hz * rate(scenario, fpga)
        warm = floor(max(span[0] - SENSOR_LEAD_S, Fraction(0)) * hz)
        part = odometer.stimulus.slice(warm, floor(span[1] * hz)).shift(-warm)
        name = f"odometer of FPGA {fpga}"
        yield Case(name, odometer_design(unit.odometer), part, warm / hz, part.end)
    hz = unit.link.clock_hz * rate(scenario, 1)
    cycle = unit.link.cycle_ticks
    warm = max(floor(span[0] * hz) // cycle - LINK_LEAD_CYCLES, 0) * cycle
    part = run.link.stimulus.slice(warm, floor(span[1] * hz)).shift(-warm)
    yield Case("position link", link_design(unit.link), part, warm / hz, part.end)
    yield _vital(run.vital.scenario, unit.vital, span)


def _vital(scenario: VitalScenario, config: VitalConfig, span: Span) -> Case:
    lead = ready_s(config) + VITAL_LEAD_CYCLES * config.cycle_s
    skipped = max(floor((span[0] - lead) / config.cycle_s), 0)
    start = skipped * config.cycle_s
    later = _later(scenario, config, skipped) if skipped else scenario
    seconds = span[1] - start
    faults = tuple(fault for fault in later.faults if fault.start_s < seconds)
    tests = tuple(at for at in later.tests_s if at < seconds)
    later = replace(later, seconds=seconds, faults=faults, tests_s=tests)
    stimulus = later.controls(config)
    design = loop(config, later.relay, later.clocks(config))
    ticks = sum(int(later.seconds / clock.period) for clock in design.clocks)
    return Case("vital output", design, stimulus, start, ticks)


def _later(scenario: VitalScenario, config: VitalConfig, skipped: int) -> VitalScenario:
    """The scenario from after so many of its cycles on."""
    start = skipped * config.cycle_s
    clock_1, clock_2, _ = scenario.clocks(config)
    cpus = scenario.cpus
    return replace(
        scenario,
        commands=_commands(scenario, start, ready_s(config)),
        phase_1=_phase(clock_1, start),
        phase_2=_phase(clock_2, start),
        cpus=replace(cpus, first_sequence=cpus.first_sequence + skipped),
        first_index=scenario.first_index + skipped,
        tests_s=tuple(at - start for at in scenario.tests_s if at >= start),
        faults=tuple(_faults(scenario, start)),
    )


def _phase(clock: Clock, start: Fraction) -> Fraction:
    """Of the same clock, if time begins with `start`."""
    return (clock.phase - start / clock.period) % 1


def _commands(scenario: VitalScenario, start: Fraction, ready: Fraction) -> tuple[Command, ...]:
    """0 until the start-up test is over, then what was commanded."""
    held = [each for each in scenario.commands if each.start_s <= start + ready]
    rest = [each for each in scenario.commands if each.start_s > start + ready]
    first = [replace(held[-1], start_s=ready)] if held else []
    return (*first, *(replace(each, start_s=each.start_s - start) for each in rest))


def _faults(scenario: VitalScenario, start: Fraction) -> Iterator[Fault]:
    """Those that are still there after the start, or come."""
    for fault in scenario.faults:
        end = fault.end_s
        if end is None and FAULTS[fault.kind].lasting:
            end = scenario.seconds
        if fault.start_s >= start:
            until = None if fault.end_s is None else fault.end_s - start
            yield replace(fault, start_s=fault.start_s - start, end_s=until)
        elif end is not None and end > start:
            yield replace(fault, start_s=Fraction(0), end_s=end - start)
