"""A channel's status from a run, and as bytes and back."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from railgate.vital_output.host import Status, status_bytes
from railgate.vital_output.spec import CAUSES, Cause, Config, State, TestPhase, pack
from railgate.waves import Trace, Waveform
from vital_output.small import SMALL

WIDE = Config(outputs=64, release_min_s=Fraction(5, 1000))
CONFIGS = (Config(), SMALL, WIDE)
SPECIAL = {"states", "first_cause"}


def start(config: Config) -> dict[str, int]:
    return {field.name: field.start for field in config.fields}


@st.composite
def statuses(draw: st.DrawFn) -> tuple[Config, dict[str, int]]:
    """A configuration and the numbers of all its fields."""
    config = draw(st.sampled_from(CONFIGS))
    values = {
        field.name: draw(st.integers(0, (1 << field.width) - 1))
        for field in config.fields
        if field.name not in SPECIAL
    }
    states = draw(
        st.lists(st.sampled_from(State), min_size=config.outputs, max_size=config.outputs)
    )
    values["states"] = sum(state << 3 * i for i, state in enumerate(states))
    values["first_cause"] = draw(st.sampled_from(Cause))
    return config, values


def run(config: Config, values: dict[str, int], prefix: str = "") -> Trace:
    """The fields as outputs that are as at start until tick 5 and then have these values."""
    signals = {}
    for field in config.fields:
        for low in range(0, field.width, 64):
            width = min(64, field.width - low)
            both = [
                number >> low & (1 << width) - 1 for number in (field.start, values[field.name])
            ]
            name = f"{field.name}.{low // 64}" if field.width > 64 else field.name
            signals[prefix + name] = Waveform.of([0, 5], both, width)
    return Trace(signals, Fraction(1, config.clock_hz), 0, 9)


def test_at_start_nothing_drives_and_nothing_has_happened() -> None:
    status = Status.at(SMALL, run(SMALL, start(SMALL)), 0)
    assert (status.index, status.sequence, status.life, status.image) == (0, 0, 0, 0)
    assert (status.acknowledge, status.blocked) == (3, 3)
    assert status.states == (State.IDLE, State.IDLE)
    assert status.test_phase is TestPhase.WANTED
    flags = (status.trusted, status.linked, status.drifting, status.latched)
    assert flags == (False,) * 4
    assert (status.first_cause, status.first_output) == (Cause.NONE, 0)
    assert status.causes == dict.fromkeys(CAUSES, 0)


def test_each_field_is_read_by_its_meaning() -> None:
    values: dict[str, int] = {
        **start(SMALL),
        "trusted": 1, "linked": 1, "life": 3, "states": 2 | 6 << 3, "test_phase": 2,
        "first_cause": 21, "first_output": 1, "accepted_count": 7, "start_count": 1,
        "lost_count": 2, "passed_count": 6, "stored_count": 5, "skew_count": 4,
        "feedback_alarm_count": 9,
    }  # fmt: skip
    status = Status.at(SMALL, run(SMALL, values, "fpga_2."), 5, "fpga_2.")
    assert status.states == (State.DRIVE, State.FEEDBACK_ALARM)
    assert (status.trusted, status.linked, status.drifting) == (True, True, False)
    assert (status.test_phase, status.life) == (TestPhase.DONE, 3)
    assert (status.first_cause, status.first_output) == (Cause.FEEDBACK_ALARM, 1)
    counts = (status.accepted, status.start, status.lost, status.passed, status.stored)
    assert counts == (7, 1, 2, 6, 5)
    assert {cause: n for cause, n in status.causes.items() if n} == {
        Cause.SKEW: 4,
        Cause.FEEDBACK_ALARM: 9,
    }


@given(statuses())
def test_bytes_and_a_run_tell_the_same_and_come_back(drawn: tuple[Config, dict[str, int]]) -> None:
    config, values = drawn
    status = Status.at(config, run(config, values), 5)
    data = status.to_bytes(config)
    assert int.from_bytes(data, "big") == pack(config.fields, values)
    assert len(data) == status_bytes(config)
    assert Status.from_bytes(config, data) == status
    for i, state in enumerate(status.states):
        assert values["states"] >> 3 * i & 7 == state


def test_the_first_field_is_in_the_first_bytes() -> None:
    values = {**start(SMALL), "index": 0x0102_0304, "upset_count": 0xFE}
    data = Status.of(SMALL, values).to_bytes(SMALL)
    used = sum(field.width for field in SMALL.fields)
    spare = 8 * len(data) - used
    assert 0 <= spare < 8
    assert int.from_bytes(data[:5], "big") >> 8 - spare == 0x0102_0304
    assert data[-1] == 0xFE


def test_what_is_no_status_is_refused() -> None:
    size, used = status_bytes(SMALL), sum(field.width for field in SMALL.fields)
    with pytest.raises(ValueError, match=f"a status must have {size} bytes, not {size - 1}"):
        Status.from_bytes(SMALL, bytes(size - 1))
    spare = 8 * size - used
    assert spare > 0
    for first in (0x80, 1 << 8 - spare):
        with pytest.raises(ValueError, match=f"must begin with {spare} zeros, not {first:#x}"):
            Status.from_bytes(SMALL, bytes([first]) + bytes(size - 1))
    for name, value, error in (
        ("states", 7 << 3, "state 1 must be between 0 and 6, not 7"),
        ("first_cause", 24, "first_cause must be between 0 and 23, not 24"),
    ):
        values: dict[str, Any] = {**start(SMALL), name: value}
        with pytest.raises(ValueError, match=error):
            Status.of(SMALL, values)
        with pytest.raises(ValueError, match=error):
            Status.at(SMALL, run(SMALL, values), 5)
