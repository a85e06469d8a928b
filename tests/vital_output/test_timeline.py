"""What happened in a run, as a person reads it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import pytest
from hypothesis import given
from hypothesis import strategies as st

from railgate.vital_output.plant.cpu import Command
from railgate.vital_output.plant.faults import fault
from railgate.vital_output.simulate import Run, simulate
from railgate.vital_output.spec import CAUSES, Cause, Config
from railgate.vital_output.timeline import FRAMES, PLAIN, Event, folded, hexadecimal, named
from vital_output.runs import run_of, scenario_of
from vital_output.small import SMALL

CYCLE = SMALL.cycle_s


def told(run: Run, source: str) -> list[str]:
    return [event.what for event in run.events if event.source == source]


def time_of(run: Run, source: str, begins: str) -> float:
    return next(e.time_s for e in run.events if e.source == source and e.what.startswith(begins))


def test_a_command_is_told_from_frame_to_contact_in_order_of_cause_and_effect() -> None:
    run = run_of("good")
    begin = time_of(run, "CPUs", "command image 0x1")
    end = begin + float(CYCLE)
    for source in ("FPGA 1", "FPGA 2"):
        here = [e.what for e in run.events if e.source == source and begin <= e.time_s < end]
        number = here[0].split()[1]
        assert here == [
            f"frame {number} image 0x1, accepted",
            "vote passed",
            "stored: image 0x1, life 3",
            "output 0: idle → pre-drive",
            "output 0: pre-drive → drive, pulses on",
        ]
    closes = time_of(run, "relay", "output 0: contact closes")
    pulses = max(time_of(run, f"FPGA {fpga}", "output 0: pre-drive → drive") for fpga in (1, 2))
    assert pulses < closes < pulses + 1.5e-3
    assert [event.time_s for event in run.events] == sorted(event.time_s for event in run.events)


def test_times_are_those_of_the_registers() -> None:
    run = run_of("good")
    for channel in run.channels:
        states = channel.state(0)
        at = [e.time_s for e in run.events if e.source == f"FPGA {channel.fpga}" and "→" in e.what]
        for tick in states.ticks[1:].tolist():
            assert tick / 10**15 in at


def test_an_ordinary_run_is_told_in_few_lines_however_long_it_is() -> None:
    lines = []
    for cycles in (40, 400):
        scenario = replace(scenario_of("good"), seconds=cycles * CYCLE)
        lines.append(folded(simulate(scenario, SMALL).events, CYCLE))
    short, long = (
        [(e.source, e.what) for e in events if e.source not in ("FPGA 1", "FPGA 2")]
        for events in lines
    )
    assert len(lines[0]) == len(lines[1]) < 80
    assert [what for source, what in short if source] == [what for source, what in long if source]
    assert len([what for source, what in long if not source]) == 3


def test_a_life_that_ends_is_told_step_by_step() -> None:
    run = run_of("cpu-dead")
    assert told(run, "fault") == ["cpu-1-dead: CPU 1 sends nothing"]
    for source in ("FPGA 1", "FPGA 2"):
        lives = [what for what in told(run, source) if what.startswith("life")]
        assert lives == ["life 3 → 2", "life 2 → 1", "life 1 → 0, the image is forced to 0"]
        after = told(run, source)[told(run, source).index(lives[-1]) + 1 :]
        assert after[0] == "output 0: drive → wait, pulses off"
    (opens,) = [what for what in told(run, "relay") if "opens" in what]
    worst = run.verdict.worst_s("failure")
    assert worst
    assert opens == f"output 0: contact opens, {float(worst) * 1e3:.3f} ms after the last live 1"


def test_a_contact_that_welds_is_told_when_its_time_is_over() -> None:
    run = run_of("welded-contact")
    at = time_of(run, "relay", "output 0: contact closed longer than declared")
    (closing,) = run.verdict.closings
    assert closing.live
    assert at == pytest.approx(closing.live / 1e15 + float(SMALL.reaction_s), abs=1e-12)


def test_a_reset_a_test_and_blocked_outputs_are_told() -> None:
    run = run_of("channel-restart")
    assert told(run, "FPGA 1").count("is reset") == 1
    assert "outputs 0–1 blocked" in told(run, "FPGA 2")
    for source in ("FPGA 1", "FPGA 2"):
        assert "output 0 may drive: a live 0 has come" in told(run, source)
        assert told(run, source).count("test of the shut-off paths: running → done") == 2
    assert "link of FPGA 1 lost" in told(run, "FPGA 2")
    assert "output 0: contact closes without a live 1" in told(run_of("test-fails"), "relay")


@cache
def busy() -> Run:
    """Much at once: frames of all kinds, an alarm that is acknowledged, a latch."""
    config = replace(SMALL, error_interval_s=4 * CYCLE)
    kinds = ("repetition-1", "corruption-2", "masquerade-1", "delay-1", "insertion-2")
    faults = [fault(f"{kind}@{float((10 + 6 * i) * CYCLE)}s") for i, kind in enumerate(kinds)]
    faults.append(fault(f"link-noise:20@{float(40 * CYCLE)}s..{float(42 * CYCLE)}s"))
    faults.append(fault(f"pulse-open-1:1@{float(8 * CYCLE)}s..{float(9 * CYCLE)}s"))
    faults.append(fault(f"corruption-2@{float(50 * CYCLE)}s..{float(52 * CYCLE)}s"))
    commands = [(6, 3, 0), (48, 0, 0), (49, 0, 2), (54, 0, 0), (56, 0, 1)]
    scenario = replace(
        scenario_of("good"),
        commands=tuple(
            Command(start_s=cycle * CYCLE, image=image, acknowledge=acknowledge)
            for cycle, image, acknowledge in commands
        ),
        seconds=60 * CYCLE,
        faults=tuple(faults),
        tests_s=(58 * CYCLE,),
    )
    return simulate(scenario, config)


@pytest.mark.parametrize(
    ("source", "what"),
    [
        ("FPGA 1", "frame 8, image 0x3, rejected: repetition"),
        ("FPGA 2", "frame rejected: corruption"),
        ("FPGA 1", "frame 20, image 0x3, rejected: masquerade"),
        ("FPGA 1", "frame 26, image 0x3, rejected: delay"),
        ("FPGA 2", "frame 36, image 0x3, rejected: insertion"),
        ("FPGA 1", "1 frame lost"),
        ("FPGA 1", "vote failed: only one of the two frames came within τ0"),
        ("FPGA 2", "message of FPGA 1 rejected: check"),
        ("FPGA 1", "output 1: drive → feedback alarm, pulses off"),
        ("FPGA 1", "output 1 acknowledged"),
        ("FPGA 2", "latched: frames rejected too often"),
        ("FPGA 2", "latch free"),
        ("CPUs", "command image 0x0, acknowledge 0x2"),
        ("CPUs", "test of the shut-off paths demanded"),
        ("fault", "pulse-open-1:1: FPGA 1 sees its pulses as 0"),
        ("fault", "pulse-open-1:1 ends"),
    ],
)
def test_what_goes_wrong_is_told_by_its_name(source: str, what: str) -> None:
    assert what in told(busy(), source)


def test_every_event_that_is_counted_is_told() -> None:
    with_changes = {Cause.LIFE_OUT, Cause.HANDSHAKE_ALARM, Cause.FEEDBACK_ALARM}
    assert {c.name.lower() for c in {*CAUSES} - with_changes} <= {*FRAMES, *PLAIN}
    for channel in busy().channels:
        here = told(busy(), f"FPGA {channel.fpga}")
        assert sum(what.startswith("frame ") for what in here) == (
            sum(channel.total(name) for name in FRAMES)
        )
        assert here.count("vote passed") == channel.total("passed")
        assert sum(what.startswith("stored") for what in here) == channel.total("stored")


def at(cycle: float, source: str, what: str) -> Event:
    return Event(float(cycle * CYCLE), source, what)


def test_cycles_are_alike_whatever_their_numbers_and_the_order_of_both_fpgas() -> None:
    events = [
        at(cycle + (0.1 if cycle % 2 == fpga % 2 else 0.2), f"FPGA {fpga}", f"frame {cycle} is in")
        for cycle in range(5)
        for fpga in (1, 2)
    ]
    events = sorted([*events, at(5, "CPUs", "command")], key=lambda event: event.time_s)
    shown = folded(events, CYCLE)
    assert [event.what for event in shown] == (
        ["frame 0 is in", "frame 0 is in", "… 4 cycles alike …", "command"]
    )
    assert [event.source for event in shown[2:]] == ["", "CPUs"]


def test_what_differs_is_never_folded() -> None:
    def lines(*whats: str) -> list[str]:
        return [e.what for e in folded([at(i, "", w) for i, w in enumerate(whats)], CYCLE)]

    assert lines("life 3 → 2", "life 2 → 1") == ["life 3 → 2", "life 2 → 1"]
    assert lines("a", "b", "a") == ["a", "b", "a"]
    apart = [at(0, "", "a"), at(2, "", "a")]
    assert folded(apart, CYCLE) == apart, "a cycle in which nothing happens is not alike"


def test_many_events_alike_in_a_cycle_are_one_line() -> None:
    events = [at(part / 100, f"FPGA {1 + part % 2}", "wrong") for part in range(14)]
    assert [(e.source, e.what) for e in folded(events, CYCLE)] == [
        ("FPGA 1", "wrong, 7 × in this cycle"),
        ("FPGA 2", "wrong, 7 × in this cycle"),
    ]
    assert folded(events[:6], CYCLE) == events[:6]


@given(st.lists(st.tuples(st.integers(0, 40), st.sampled_from("abc")), max_size=40))
def test_folding_leaves_no_kind_of_event_out(told: list[tuple[int, str]]) -> None:
    events = [at(quarter / 4, "FPGA 1", what) for quarter, what in sorted(told)]
    shown = [event for event in folded(events, CYCLE) if event.source]
    assert {event.what[0] for event in shown} == {event.what for event in events}
    assert len(shown) <= len(events)


@pytest.mark.parametrize(
    ("outputs", "name"),
    [(1, "output 0"), (0b11, "outputs 0–1"), (0b1011, "outputs 0–1, 3"), (0b100, "output 2")],
)
def test_outputs_are_named_in_runs(outputs: int, name: str) -> None:
    assert named(outputs) == name


def test_an_image_has_a_digit_for_each_four_outputs() -> None:
    assert hexadecimal(SMALL, 1) == "0x1"
    assert hexadecimal(Config(), 1) == "0x0001"
