"""Times swept tick by tick around their limits, and thousands of switches, with unrelated clocks.

Requirements DRV-6, DRV-9, DRV-14.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.vital_output.plant.cpu import Command, Frame
from railgate.vital_output.plant.edges import FEMTOSECOND
from railgate.vital_output.plant.scenario import Scenario
from railgate.vital_output.simulate import Run
from railgate.vital_output.situations import ready_s
from railgate.vital_output.spec import State
from vital_output.pair import RELAY, busy, driving, entries, frames_of, inputs, run, wrong
from vital_output.scenarios import clocks
from vital_output.small import SMALL

pytestmark = pytest.mark.shows("DRV-14", kind="sweep")

TICK = 10**15 // SMALL.clock_hz
"""Femtoseconds."""

L, TAU0, TAU1 = SMALL.latency_ticks, SMALL.tau0_ticks, SMALL.tau1_ticks
DRIFT = SMALL.drift_in(TAU0)
PASSES, FAILS = TAU0 - L - DRIFT, TAU0 + L + DRIFT
"""The skew of two frames up to which they pass, and beyond which they fail, in ticks."""

APART = 4
"""Cycles from one swept frame to the next: one that fails may cost the next cycle too."""

DELAYS = st.integers(0, SMALL.line_ticks)


def skewed(scenario: Scenario, phase: int, skews: Sequence[int]) -> tuple[list[Frame], list[Frame]]:
    """Frames at a phase of each cycle, from the first command on now and then one of them later by
    the next of the skews; less than 0: it is CPU 1's."""
    first = int(scenario.commands[0].start_s / SMALL.cycle_s) + 2
    late = {first + APART * i: skew for i, skew in enumerate(skews)}
    found: tuple[list[Frame], list[Frame]] = ([], [])
    for cpu, frames in enumerate(frames_of(scenario, SMALL)):
        for frame in frames:
            by = late.get(frame.cycle, 0) * (1 if cpu else -1)
            tick = frame.cycle * SMALL.cycle_ticks + phase + max(by, 0)
            found[cpu].append(replace(frame, sent=tick * TICK))
    return found


def verdicts(found: Run, skews: Sequence[int]) -> list[tuple[Fraction, bool, bool]]:
    """Of each swept pair of frames the skew in ticks, and whether FPGA 1 and 2 stored it."""
    first = int(found.scenario.commands[0].start_s / SMALL.cycle_s) + 2
    stored = [{frame.tick for _, frame in channel.stores} for channel in found.channels]
    told = []
    for i in range(len(skews)):
        number = first + APART * i - found.scenario.cpus.first_cycle
        one, other = (channel.frames[number] for channel in found.channels)
        skew = Fraction(other.at - one.at, TICK)
        told.append((skew, one.tick in stored[0], other.tick in stored[1]))
    return told


def assert_skews(
    timing: dict[str, Fraction], delay_ticks: int, phase: int, skews: Sequence[int]
) -> list[tuple[Fraction, bool, bool]]:
    scenario = driving(SMALL, 4 + APART * len(skews), **timing)
    given_ = inputs(scenario, SMALL, frames=skewed(scenario, phase, skews))
    found = run(scenario, SMALL, given_, delay_ticks)
    told = verdicts(found, skews)
    for skew, *stored in told:
        assert stored[0] == stored[1], (skew, stored)
        assert stored[0] or abs(skew) > PASSES, skew
        assert not stored[0] or abs(skew) <= FAILS, skew
    assert found.trace["contact"].values.tolist() == [0, 1]
    assert all(causes.keys() <= {"skew", "mismatch"} for causes in wrong(found))
    return told


def around(ticks: int, few: int) -> list[int]:
    """Each tick near to this skew, of either CPU's frames."""
    return [sign * (ticks + by) for by in range(-few, few + 1) for sign in (1, -1)]


PHASE = SMALL.margin_ticks - 2 * SMALL.slew_ticks
EARLY, LATE = -PHASE, SMALL.cycle_ticks + PHASE - PASSES - 2 * SMALL.layout.frame_bytes
"""The first and the last phase that frames may have in a cycle, so far apart."""


@pytest.mark.shows("DRV-1", "DRV-6")
@given(clocks(), DELAYS, st.data())
@settings(max_examples=10, deadline=None)
def test_frames_pass_up_to_the_skew_that_is_declared_and_fail_beyond(
    timing: dict[str, Fraction], delay_ticks: int, data: st.DataObject
) -> None:
    phase = data.draw(st.integers(EARLY, SMALL.cycle_ticks - FAILS - 500))
    between = data.draw(st.lists(st.integers(PASSES, FAILS), min_size=6, max_size=6))
    skews = around(PASSES, 2) + around(FAILS, 2) + between
    told = assert_skews(timing, delay_ticks, phase, data.draw(st.permutations(skews)))
    assert {stored for _, stored, _ in told} == {True, False}


@pytest.mark.shows("DRV-6")
@given(clocks(), DELAYS, st.integers(EARLY, LATE), st.data())
@settings(max_examples=6, deadline=None)
def test_frames_pass_wherever_they_are_in_their_cycle(
    timing: dict[str, Fraction], delay_ticks: int, phase: int, data: st.DataObject
) -> None:
    skews = data.draw(st.lists(st.integers(-PASSES, PASSES), min_size=8, max_size=8))
    told = assert_skews(timing, delay_ticks, phase, [PASSES, -PASSES, *skews])
    assert all(stored for _, stored, _ in told)


CYCLE = SMALL.cycle_s
OUTPUT = 0
ON, OFF = 2, 3
SETTLED = 2
"""Cycles after which the contact has followed a command."""
"""Cycles for which it is commanded on and off."""


def switching(trials: int, timing: dict[str, Fraction]) -> Scenario:
    """Output 0 on and off so many times."""
    first = ready_s(SMALL) + SMALL.cycle_s
    on = [first + (ON + OFF) * i * SMALL.cycle_s for i in range(trials)]
    commands = [Command(start_s=t + o, image=i) for t in on for o, i in ((0, 1), (ON * CYCLE, 0))]
    seconds = first + (ON + OFF) * trials * SMALL.cycle_s
    return Scenario(commands=tuple(commands), seconds=seconds, relay=RELAY, **timing)


def assert_handshakes(
    timing: dict[str, Fraction], delay_ticks: int, late_fpga: int, lates: Sequence[int]
) -> list[bool]:
    """One FPGA's output comes from WAIT into PRE_DRIVE so many ticks after the other's, each time.
    Whether both then drive; if not, neither does for long, and both tell so."""
    scenario = switching(len(lates), timing)
    plain = run(scenario, SMALL, None, delay_ticks)
    begun = entries(plain, 3 - late_fpga, OUTPUT, State.PRE_DRIVE)
    spans = [(at - 2000 * TICK, at + late * TICK) for at, late in zip(begun, lates, strict=True)]
    wires = {f"relay.stuck_{late_fpga}": busy(scenario, SMALL, late_fpga, spans)}
    found = run(scenario, SMALL, inputs(scenario, SMALL, wires=wires), delay_ticks)
    assert entries(found, 3 - late_fpga, OUTPUT, State.PRE_DRIVE) == begun
    closings = found.trace["contact"].rising()
    alarms = [entries(found, fpga, OUTPUT, State.HANDSHAKE_ALARM) for fpga in (1, 2)]
    trials = [
        (command.start_s, command.start_s + (ON + OFF) * CYCLE)
        for command in scenario.commands[::2]
    ]
    told = []
    for entered, other, late, trial in zip(
        entries(found, late_fpga, OUTPUT, State.PRE_DRIVE), begun, lates, trials, strict=True
    ):
        assert abs(entered - other - late * TICK) <= 12 * TICK
        begin, end = (int(time / FEMTOSECOND) for time in trial)
        driven, *alarmed = (
            [begin < at < end for at in times].count(True) for times in (closings, *alarms)
        )
        assert (driven, alarmed) in ((1, [0, 0]), (0, [1, 1]))
        assert driven or entered - other > (TAU1 - L - DRIFT) * TICK
        assert not driven or entered - other <= (TAU1 + DRIFT) * TICK
        told.append(driven == 1)
    count = told.count(False)
    assert wrong(found) == (({"handshake_alarm": count},) * 2 if count else ({}, {}))
    return told


@pytest.mark.shows("DRV-9")
@given(clocks(), DELAYS, st.sampled_from((1, 2)), st.data())
@settings(max_examples=8, deadline=None)
def test_outputs_drive_up_to_the_skew_in_leaving_that_is_declared_and_both_tell_beyond(
    timing: dict[str, Fraction], delay_ticks: int, late_fpga: int, data: st.DataObject
) -> None:
    sure, never = (
        [least + by for by in range(-12, 4)] for least in (TAU1 - L - DRIFT, TAU1 + DRIFT)
    )
    lates = [data.draw(st.sampled_from(few)) for few in (sure, never) for _ in range(3)]
    lates += data.draw(st.lists(st.integers(sure[0], never[-1]), min_size=2, max_size=2))
    told = assert_handshakes(timing, delay_ticks, late_fpga, data.draw(st.permutations(lates)))
    assert set(told) == {True, False}


@pytest.mark.shows("DRV-1", "DRV-6")
@pytest.mark.slow
@given(clocks(), DELAYS, st.integers(EARLY, SMALL.cycle_ticks - FAILS - 500), st.data())
@settings(max_examples=200, deadline=None)
def test_frames_pass_up_to_the_skew_that_is_declared_and_fail_beyond_for_long(
    timing: dict[str, Fraction], delay_ticks: int, phase: int, data: st.DataObject
) -> None:
    between = data.draw(st.lists(st.integers(PASSES, FAILS), min_size=20, max_size=20))
    assert_skews(timing, delay_ticks, phase, around(PASSES, 5) + around(FAILS, 5) + between)


@pytest.mark.shows("DRV-9")
@pytest.mark.slow
@given(clocks(), DELAYS, st.sampled_from((1, 2)), st.booleans())
@settings(max_examples=100, deadline=None)
def test_outputs_drive_up_to_the_skew_in_leaving_that_is_declared_for_long(
    timing: dict[str, Fraction], delay_ticks: int, late_fpga: int, last: bool
) -> None:
    least = TAU1 + DRIFT if last else TAU1 - L - DRIFT
    assert_handshakes(timing, delay_ticks, late_fpga, range(least - 20, least + 8))
