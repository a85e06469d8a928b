"""The event log on the disk: whole after whatever a loss of power leaves (SYS-6)."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from railgate.unit.events import Event
from railgate.unit.log import Log

EVENTS = [
    Event(0.0, "FPGA 1", "outputs 0–1: idle → test, pulses on", None, None),
    Event(53.0071, "FPGA 2", "vote failed: only one of the two frames came within τ0", 0.0, 400.0),
    Event(53.177, "relay", "output 1: contact opens", 12.25, 399.5),
]
WHOLE = st.floats(allow_nan=False, allow_infinity=False)
ANY = st.builds(Event, WHOLE, st.text(), st.text(), st.none() | WHOLE, st.none() | WHOLE)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "events.jsonl"


def lines(path: Path) -> list[bytes]:
    return path.read_bytes().splitlines(keepends=True)


@pytest.mark.shows("SYS-6")
def test_each_event_is_on_the_disk_with_time_speed_and_place_when_append_returns(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    synced: list[int] = []
    sync = os.fsync
    monkeypatch.setattr(os, "fsync", lambda file: (sync(file), synced.append(len(lines(path)))))
    with Log(path) as log:
        for number, event in enumerate(EVENTS):
            log.append(event)
            assert synced[-1] == number + 1
            told = json.loads(lines(path)[-1])
            assert told == {"number": number, "since": number, **vars(event)}


@given(first=st.lists(ANY, max_size=5), second=st.lists(ANY, max_size=5))
def test_what_was_appended_is_read_back(
    tmp_path_factory: pytest.TempPathFactory, first: list[Event], second: list[Event]
) -> None:
    path = tmp_path_factory.mktemp("log") / "events.jsonl"
    for part in (first, second):
        with Log(path) as log:
            log.append(*part)
    with Log(path) as log:
        assert log.events == [*first, *second]


@pytest.mark.shows("SYS-6")
def test_a_line_that_a_loss_of_power_cut_anywhere_goes_and_nothing_else(path: Path) -> None:
    with Log(path) as log:
        for event in EVENTS:
            log.append(event)
    *kept, last = lines(path)
    for left in range(len(last)):
        path.write_bytes(b"".join(kept) + last[:left])
        with Log(path) as log:
            assert log.events == EVENTS[:2]
            log.append(EVENTS[2])
        assert lines(path) == [*kept, last]


@pytest.mark.parametrize("rest", [b"\0" * 4096, b'{"number": 9}\n', b"[2]\n", b"\xff\n\n"])
def test_what_the_disk_held_behind_the_last_line_goes(path: Path, rest: bytes) -> None:
    with Log(path) as log:
        log.append(*EVENTS)
    whole = path.read_bytes()
    path.write_bytes(whole + rest)
    with Log(path) as log:
        assert log.events == EVENTS
    assert path.read_bytes() == whole


def test_of_an_append_that_did_not_return_the_lines_before_the_first_lost_one_stay(
    path: Path,
) -> None:
    """Blocks of one write may reach the disk in any order."""
    with Log(path) as log:
        log.append(EVENTS[0])
        log.append(EVENTS[1], EVENTS[2], EVENTS[0])
    first, second, third, fourth = lines(path)
    path.write_bytes(first + second + b"\0" * len(third) + fourth)
    with Log(path) as log:
        assert log.events == EVENTS[:2]
    assert lines(path) == [first, second]


def test_damage_before_the_last_append_is_told_and_nothing_is_changed(path: Path) -> None:
    with Log(path) as log:
        for event in EVENTS:
            log.append(event)
    first, second, third = lines(path)
    damaged = first + second.replace(b"vote", b"vo\0e") + third
    path.write_bytes(damaged)
    with pytest.raises(ValueError, match=r"events\.jsonl:2: the line is damaged"):
        Log(path)
    assert path.read_bytes() == damaged


def test_a_log_that_cannot_be_is_one_line_of_error(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="No such file or directory"):
        Log(tmp_path / "missing" / "events.jsonl")
