"""Each built-in situation ends as its sentence says."""

from __future__ import annotations

import json
from fractions import Fraction

import pytest

from railgate.vital_output.situations import SITUATIONS, on_and_off, ready_s
from railgate.vital_output.spec import Cause, Config, State
from vital_output.runs import run_of
from vital_output.small import SMALL

BOTH_IDLE = (State.IDLE, State.IDLE)
ALARMS = (State.FEEDBACK_ALARM, State.FEEDBACK_ALARM)
ENDS: dict[str, tuple[list[str | None], tuple[State, State], tuple[Cause, Cause]]] = {
    "good": (["command"], BOTH_IDLE, (Cause.NONE, Cause.NONE)),
    "cpu-dead": (["failure"], BOTH_IDLE, (Cause.SKEW, Cause.SKEW)),
    "cpus-disagree": (["failure"], BOTH_IDLE, (Cause.MISMATCH, Cause.MISMATCH)),
    "skew": (["failure"], BOTH_IDLE, (Cause.SKEW, Cause.SKEW)),
    "link-cut-1": (["failure"], BOTH_IDLE, (Cause.HANDSHAKE_ALARM, Cause.LINK_LOST)),
    "link-cut-2": (["failure"], BOTH_IDLE, (Cause.LINK_LOST, Cause.HANDSHAKE_ALARM)),
    "channel-restart": (
        ["failure", None],
        (State.DRIVE, State.DRIVE),
        (Cause.TIME, Cause.LINK_SEQUENCE),
    ),
    "cpu-switch-over": (
        ["failure", None],
        (State.DRIVE, State.DRIVE),
        (Cause.LIFE_OUT, Cause.LIFE_OUT),
    ),
    "clock-stopped": (["failure"], (State.DRIVE, State.IDLE), (Cause.NONE, Cause.LINK_LOST)),
    "clock-off": ([], BOTH_IDLE, (Cause.OSCILLATOR, Cause.OSCILLATOR)),
    "welded-contact": ([None], ALARMS, (Cause.FEEDBACK_ALARM, Cause.FEEDBACK_ALARM)),
    "broken-coil": (["failure"], ALARMS, (Cause.FEEDBACK_ALARM, Cause.FEEDBACK_ALARM)),
    "feedback-open": (
        ["failure"],
        (State.FEEDBACK_ALARM, State.HANDSHAKE_ALARM),
        (Cause.FEEDBACK_ALARM, Cause.HANDSHAKE_ALARM),
    ),
    "feedback-stuck": (
        ["failure"],
        (State.FEEDBACK_ALARM, State.HANDSHAKE_ALARM),
        (Cause.FEEDBACK_ALARM, Cause.HANDSHAKE_ALARM),
    ),
    "time-lost": (["failure"], BOTH_IDLE, (Cause.TIME, Cause.SKEW)),
    "test-fails": (
        ["failure"],
        (State.FEEDBACK_ALARM, State.IDLE),
        (Cause.FEEDBACK_ALARM, Cause.NONE),
    ),
}
"""What opened the contact of output 0 each time, its states at the end, and the first causes."""


@pytest.mark.shows("DRV-16")
@pytest.mark.parametrize("situation", SITUATIONS)
def test_it_ends_as_told_and_only_a_welded_contact_stays_closed_too_long(situation: str) -> None:
    run = run_of(situation)
    opened_by, states, first = ENDS[situation]
    assert [each.opened_by for each in run.verdict.closings] == opened_by
    assert {each.output for each in run.verdict.closings} <= {0}
    assert tuple(c.state(0).values[-1] for c in run.channels) == states
    assert tuple(c.wave("first_cause").values[-1] for c in run.channels) == first
    assert run.as_json()["safe"] is (situation != "welded-contact")
    assert json.loads(json.dumps(run.as_json(), allow_nan=False)) == run.as_json()


def test_before_it_is_ready_nothing_drives_and_then_everything_may() -> None:
    run = run_of("good")
    ready = int(ready_s(SMALL) * 10**15)
    for channel in run.channels:
        assert channel.wave("test_phase").ticks[-1] < ready
        assert channel.wave("blocked").at(ready) == 0


def test_output_0_is_on_in_the_middle_third_of_what_is_left() -> None:
    config = Config()
    start = ready_s(config)
    on, off = on_and_off(config, start + 3)
    assert (on.start_s, off.start_s) == (start + 1, start + 2)
    assert (on.image, off.image) == (1, 0)
    assert on_and_off(config, start) == ()


@pytest.mark.parametrize("situation", SITUATIONS)
@pytest.mark.parametrize(
    "config",
    [
        Config(),
        Config(life_cycles=15),
        Config(cycle_s=Fraction(1, 5), slew_ticks=640, holdover_cycles=25),
    ],
    ids=["default", "long life", "slow"],
)
def test_it_can_be_planned_for_other_configurations(situation: str, config: Config) -> None:
    scenario = SITUATIONS[situation].make(config)
    assert scenario.controls(config).end == scenario.seconds * 10**15
