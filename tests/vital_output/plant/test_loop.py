"""Both channels in a closed loop: they start, test, drive and stop; each fault ends as it should.

Requirements DRV-5 to DRV-18.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
import pytest

from railgate.engines import Clock, Engine, open_engine
from railgate.vital_output.host import Status
from railgate.vital_output.loop import loop
from railgate.vital_output.plant.cpu import Command
from railgate.vital_output.plant.edges import FEMTOSECOND
from railgate.vital_output.plant.faults import FAULTS, fault
from railgate.vital_output.plant.relay import RelayTimes, contacts
from railgate.vital_output.plant.scenario import Scenario
from railgate.vital_output.spec import Cause, State, TestPhase
from railgate.waves import Trace
from vital_output.small import SMALL

CYCLE = SMALL.cycle_s
RELAY = RelayTimes(pick_up_s=Fraction(8, 10_000), release_s=Fraction(7, 1000))
ON, READY, OFF, END = 6, 9, 11, 17
"""Cycles: output 0 is commanded from ON on and drives in READY; OFF ends it where it ends."""

FAULT_MS = READY * 12 + 1
"""After the frames of READY have come and before they are voted."""


def scenario(*texts: str, cycles: int = END, off: int | None = None, **settings: Any) -> Scenario:
    commands = [Command(start_s=ON * CYCLE, image=1)]
    if off is not None:
        commands.append(Command(start_s=off * CYCLE, image=0))
    return Scenario(
        **{"ppm_1": Fraction(100), "ppm_2": Fraction(-100), "relay": RELAY, **settings},
        commands=tuple(commands),
        seconds=cycles * CYCLE,
        faults=tuple(fault(text) for text in texts),
    )


@cache
def opened(clocks: tuple[Clock, ...]) -> tuple[Engine, Any]:
    """The loop in an engine, and its state at the start."""
    engine = open_engine(loop(SMALL, RELAY, clocks), "cxxrtl")
    return engine, engine.checkpoint()


def from_start(told: Scenario) -> Trace:
    """All inputs and outputs of a run, the contact's twin checked."""
    engine, start = opened(told.clocks(SMALL))
    engine.restore(start)
    inputs = told.controls(SMALL)
    found = engine.advance(inputs.end, inputs).merge(inputs)
    check_contact(told, found)
    return found


@cache
def ready() -> tuple[Engine, Trace, Any]:
    """An engine, its run until the beginning of READY, and its state there."""
    told = scenario(cycles=READY)
    found = from_start(told)
    engine, _ = opened(told.clocks(SMALL))
    return engine, found, engine.checkpoint()


def run(told: Scenario) -> Trace:
    """Likewise, of a run whose faults begin in READY."""
    engine, before, state = ready()
    engine.restore(state)
    inputs = told.controls(SMALL)
    rest = inputs.slice(engine.now, inputs.end)
    found = before.concatenate(engine.advance(inputs.end, inputs).merge(rest))
    assert found.select(inputs.signals) == inputs
    check_contact(told, found)
    return found


def check_contact(told: Scenario, found: Trace) -> None:
    expected = contacts(SMALL, RELAY, told.clocks(SMALL)[2], found)
    assert expected.first_difference(found["contact"]) is None


def tick(cycle: Fraction | int) -> int:
    return int(cycle * CYCLE / FEMTOSECOND)


def status(found: Trace, fpga: int, cycle: Fraction | int | None = None) -> Status:
    at = found.end - 1 if cycle is None else tick(cycle)
    return Status.at(SMALL, found, at, f"fpga_{fpga}.")


def causes(found: Trace, fpga: int) -> dict[Cause, int]:
    return {cause: n for cause, n in status(found, fpga).causes.items() if n}


def closed(found: Trace) -> int:
    """The contacts at the end."""
    return int(found["contact"].values[-1])


@pytest.mark.shows("DRV-8", "DRV-9", "DRV-10", "DRV-11", "DRV-18")
def test_the_pair_starts_tests_its_shut_off_paths_drives_and_stops_without_any_alarm() -> None:
    told = scenario(off=OFF)
    found = run(told)
    for fpga in (1, 2):
        assert causes(found, fpga) == {}
        phases = found[f"fpga_{fpga}.test_phase"].values.tolist()
        assert phases == [TestPhase.WANTED, TestPhase.RUNNING, TestPhase.DONE]
        states = found[f"fpga_{fpga}.states"].values & 7
        course = states[np.append(True, np.diff(states) != 0)].tolist()
        test = [State.IDLE, State.TEST, State.WAIT, State.IDLE]
        assert course == [*test, State.PRE_DRIVE, State.DRIVE, State.WAIT, State.IDLE]
        last = status(found, fpga)
        assert (last.accepted, last.passed, last.stored) == (END - 3, END - 3, END - 3)
    contact = found["contact"]
    assert contact.values.tolist() == [0, 1, 0]
    assert tick(ON) < contact.ticks[1] < tick(ON + 1)
    assert tick(OFF) < contact.ticks[2] < tick(OFF + 2)


@pytest.mark.shows("DRV-14")
def test_the_channels_start_within_the_links_latency_of_each_other() -> None:
    found = ready()[1]
    first = []
    for fpga in (1, 2):
        rises = found[f"fpga_{fpga}.pulses"].rising()
        first.append(int(rises[rises > tick(ON)][0]))
    assert abs(first[0] - first[1]) <= (SMALL.latency_ticks + 4) * 10**9


def test_the_loop_is_the_same_in_pysim_over_its_first_messages() -> None:
    told = replace(scenario("link-noise:1000@0s"), seconds=Fraction(2, 1000))
    inputs = told.controls(SMALL)
    engine = open_engine(loop(SMALL, RELAY, told.clocks(SMALL)), "pysim")
    found = engine.advance(inputs.end, inputs)
    assert found.first_difference(from_start(told).select(found.signals)) is None


OF_A_FRAME: dict[str, tuple[dict[Cause, int], dict[Cause, int]]] = {
    "repetition": ({Cause.REPETITION: 1}, {}),
    "deletion": ({Cause.SKEW: 1}, {Cause.SKEW: 1}),
    "insertion": ({Cause.INSERTION: 1}, {}),
    "resequence": (
        {Cause.RESEQUENCE: 1, Cause.MISMATCH: 1, Cause.SKEW: 1},
        {Cause.MISMATCH: 1, Cause.SKEW: 1},
    ),
    "corruption": ({Cause.CORRUPTION: 1, Cause.SKEW: 1}, {Cause.SKEW: 1}),
    "delay": ({Cause.DELAY: 1, Cause.SKEW: 1}, {Cause.SKEW: 1}),
    "masquerade": ({Cause.MASQUERADE: 1, Cause.SKEW: 1}, {Cause.SKEW: 1}),
}
"""What the FPGA that the frame comes to tells of it, and what the other."""


@pytest.mark.shows("DRV-5")
@pytest.mark.parametrize("cpu", [1, 2])
@pytest.mark.parametrize("kind", OF_A_FRAME)
def test_one_bad_frame_is_told_by_its_cause_and_the_contact_stays_closed(
    kind: str, cpu: int
) -> None:
    found = run(scenario(f"{kind}-{cpu}@{FAULT_MS}ms", cycles=READY + 3))
    assert found["contact"].values.tolist() == [0, 1]
    own, other = OF_A_FRAME[kind]
    assert causes(found, cpu) == own
    assert causes(found, 3 - cpu) == other


LOST = {Cause.SKEW, Cause.LIFE_OUT}
LINK = {Cause.LINK_LOST, Cause.HANDSHAKE_ALARM, *LOST}
TOLD = {Cause.LIFE_OUT, Cause.HANDSHAKE_ALARM}
UNEQUAL = {Cause.MISMATCH, Cause.LIFE_OUT}
NOISE = {Cause.LINK_CHECK, *LINK}
JUMP = {Cause.TIME_JUMP, Cause.TIME, Cause.FORWARD, Cause.LIFE_OUT}
ALARM, PEERS = {Cause.FEEDBACK_ALARM}, {Cause.HANDSHAKE_ALARM}

OPENS: dict[str, tuple[set[Cause], set[Cause]]] = {
    "cpu-1-dead": (LOST, LOST),
    "cpu-2-dead": (LOST, LOST),
    "disagree": (UNEQUAL, UNEQUAL),
    "skew": ({Cause.SKEW, *UNEQUAL}, {Cause.SKEW, *UNEQUAL}),
    "link-cut-1": (TOLD, LINK),
    "link-cut-2": (LINK, TOLD),
    "link-cut-1:0": (TOLD, {Cause.LINK_CHECK, *LINK}),
    "link-noise:20": (NOISE, NOISE),
    "stopped-1": (set(), LINK),
    "stopped-2": (LINK, set()),
    "time-step-1": ({Cause.DELAY, Cause.SKEW, *JUMP}, LOST),
    "time-step-2": (LOST, {Cause.DELAY, Cause.SKEW, *JUMP}),
    "time-drift-1:100000": (JUMP, LOST),
    "time-drift-2:100000": (LOST, JUMP),
    "pulse-open-1": (ALARM, PEERS),
    "pulse-open-2": (PEERS, ALARM),
    "pulse-stuck-1": (ALARM, PEERS),
    "pulse-stuck-2": (PEERS, ALARM),
    "broken-coil": (ALARM, ALARM),
    "contact-open": (ALARM, ALARM),
}
"""By the fault: what FPGA 1 and what FPGA 2 tells of it."""


@pytest.mark.shows("DRV-16")
@pytest.mark.parametrize("text", OPENS)
def test_a_lasting_fault_opens_the_contact_within_the_reaction_time(text: str) -> None:
    found = run(scenario(f"{text}@{FAULT_MS}ms"))
    assert (set(causes(found, 1)), set(causes(found, 2))) == OPENS[text]
    assert found["contact"].values.tolist() == [0, 1, 0]
    last_byte = READY * CYCLE + 2 * SMALL.margin_s + Fraction(20, 10**6)
    latest = (last_byte + SMALL.reaction_s) / FEMTOSECOND
    assert tick(READY) < found["contact"].ticks[-1] <= latest


@pytest.mark.parametrize("fpga", [1, 2])
def test_a_stopped_channel_holds_all_its_outputs_and_goes_on(fpga: int) -> None:
    told = scenario(f"stopped-{fpga}@{FAULT_MS}ms..{FAULT_MS + 5}ms", cycles=READY + 1)
    found = run(told)
    inputs = told.controls(SMALL).signals
    begin, end = inputs[f"fpga_{fpga}.stopped"].ticks[1:].tolist()
    outputs = [name for name in found.signals if name.startswith(f"fpga_{fpga}")]
    outputs = [name for name in outputs if name not in inputs]
    assert {f"fpga_{fpga}.{name}" for name in ("command.ready", "link_tx", "pulses")} < {*outputs}
    for name in outputs:
        ticks = found[name].ticks
        assert not ((ticks > begin) & (ticks <= end)).any(), name
    assert found[f"fpga_{fpga}.link_tx"].ticks[-1] > end


@pytest.mark.shows("DRV-3")
@pytest.mark.parametrize("fpga", [1, 2])
def test_without_time_the_contact_opens_when_holdover_ends(fpga: int) -> None:
    lasts = READY + SMALL.holdover_cycles
    found = run(scenario(f"time-lost-{fpga}@{FAULT_MS}ms", cycles=lasts + 6))
    assert found["contact"].values.tolist() == [0, 1, 0]
    assert found["contact"].ticks[-1] > tick(lasts)
    assert set(causes(found, fpga)) == {Cause.TIME, Cause.FORWARD, Cause.LIFE_OUT}
    assert set(causes(found, 3 - fpga)) == LOST


@pytest.mark.shows("DRV-5")
@pytest.mark.parametrize("fpga", [1, 2])
def test_after_a_restart_it_is_closed_again_only_after_a_live_0(fpga: int) -> None:
    commands = tuple(
        Command(start_s=cycle * CYCLE, image=image) for cycle, image in ((ON, 1), (14, 0), (15, 1))
    )
    found = run(replace(scenario(f"restart-{fpga}@{FAULT_MS}ms"), commands=commands))
    assert found["contact"].values.tolist() == [0, 1, 0, 1]
    assert tick(READY) < found["contact"].ticks[2] < tick(READY + 1)
    assert found["contact"].ticks[3] > tick(15)
    assert status(found, fpga, 14).blocked == status(found, 3 - fpga, 14).blocked == 1


@pytest.mark.shows("DRV-5")
def test_after_a_switch_over_it_closes_by_itself() -> None:
    found = run(scenario(f"switch-over@{FAULT_MS}ms"))
    assert found["contact"].values.tolist() == [0, 1, 0, 1]
    for fpga in (1, 2):
        assert causes(found, fpga) == {Cause.LIFE_OUT: 1}
        assert status(found, fpga).start == 2


@pytest.mark.shows("DRV-11", "DRV-12")
@pytest.mark.parametrize("text", ["rogue-1", "rogue-2", "contact-stuck", "welded"])
def test_what_the_command_off_must_find(text: str) -> None:
    """While the contact has to be closed none of these can be seen."""
    found = run(scenario(f"{text}@{FAULT_MS}ms", off=OFF))
    for fpga in (1, 2):
        assert causes(found, fpga) == ({} if "rogue" in text else {Cause.FEEDBACK_ALARM: 1})
        assert {*status(found, fpga, OFF).states} == {State.DRIVE, State.IDLE}
        assert status(found, fpga).image == 0
    assert found["contact"].values.tolist() == ([0, 1] if text == "welded" else [0, 1, 0])


@pytest.mark.shows("DRV-18")
def test_a_test_on_demand_waits_for_the_command_off_and_finds_the_rogue_train() -> None:
    found = run(scenario(f"test-fails@{FAULT_MS}ms", off=OFF))
    assert status(found, 1, OFF).test_phase is TestPhase.REQUESTED
    assert (causes(found, 1), causes(found, 2)) == ({Cause.FEEDBACK_ALARM: 1}, {})
    assert status(found, 1).states == (State.FEEDBACK_ALARM, State.IDLE)
    assert closed(found) == 0


@pytest.mark.shows("DRV-18")
@pytest.mark.parametrize("text", ["test-fails@0s", "contact-stuck@3ms"])
def test_an_output_that_fails_its_test_at_start_never_drives(text: str) -> None:
    found = from_start(scenario(text, cycles=READY))
    assert status(found, 1).states == (State.FEEDBACK_ALARM, State.IDLE)
    assert status(found, 1).image == 1
    for fpga in (1, 2):
        after = found[f"fpga_{fpga}.pulses"].ticks > tick(2)
        assert not after.any()


@pytest.mark.shows("DRV-17")
def test_with_a_clock_off_tolerance_it_never_closes() -> None:
    found = from_start(scenario(cycles=READY, ppm_1=Fraction(1000)))
    assert found["contact"].values.tolist() == [0]
    for fpga in (1, 2):
        last = status(found, fpga)
        assert last.drifting
        assert last.passed > 0
        assert last.stored == 0
        assert set(causes(found, fpga)) == {Cause.OSCILLATOR}


def test_every_kind_of_fault_is_tried() -> None:
    tried = {f"{kind}-{cpu}" for kind in OF_A_FRAME for cpu in (1, 2)}
    tried |= {text.split(":")[0] for text in OPENS}
    tried |= {f"{kind}-{fpga}" for kind in ("time-lost", "restart", "rogue") for fpga in (1, 2)}
    assert tried | {"switch-over", "contact-stuck", "welded", "test-fails"} == set(FAULTS)
