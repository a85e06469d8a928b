"""The event log on the host's disk: a line for each event, there when `append` returns (SYS-6).

A line is a JSON object: `number` counts the log's events from 0, `since` is the number of the first
event that was appended together with it, and the rest is the event: `time_s`, `source`, `what`,
`speed_kmh`, `place_m`. What a loss of power leaves of an append that had not returned is cut off
when the log is opened again; whatever was appended before is kept.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from railgate.unit.events import Event

__all__ = ["Log"]

MEMBERS = ("number", "since", "time_s", "source", "what", "speed_kmh", "place_m")


class Log:
    """A log's file, made where there is none.

    Raises ValueError where it cannot be read or written, or where a line before the last append is
    damaged, which no loss of power explains: nothing is changed then.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        try:
            made = not self.path.exists()
            self._file = os.open(self.path, os.O_RDWR | os.O_APPEND | os.O_CREAT, 0o644)
        except OSError as error:
            raise ValueError(f"{path}: cannot be opened: {error.strerror}") from error
        try:
            self._events = self._read(self.path.read_bytes())
            if made:
                _sync_folder(self.path.parent)
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        os.close(self._file)

    @property
    def events(self) -> list[Event]:
        """All of the log, in the order in which they were appended."""
        return list(self._events)

    def append(self, *events: Event) -> None:
        """Add events; all are on the disk when it returns. Raises ValueError where they cannot."""
        since = len(self._events)
        lines = [_line(number, since, event) for number, event in enumerate(events, since)]
        content = "".join(lines).encode()
        try:
            while content:
                content = content[os.write(self._file, content) :]
            os.fsync(self._file)
        except OSError as error:
            raise ValueError(f"{self.path}: cannot be written: {error.strerror}") from error
        self._events += events

    def _read(self, content: bytes) -> list[Event]:
        """The whole events; what a loss of power has left behind them is cut off."""
        lines = content.splitlines(keepends=True)
        read = [_read_line(line) for line in lines]
        whole = next((i for i, (each, _) in enumerate(read) if each.get("number") != i), len(read))
        for after, _ in read[whole:]:
            if after.get("since", whole) > whole:
                raise ValueError(f"{self.path}:{whole + 1}: the line is damaged")
        if whole < len(lines):
            os.ftruncate(self._file, sum(map(len, lines[:whole])))
            os.fsync(self._file)
        return [event for _, event in read[:whole] if event]


def _line(number: int, since: int, event: Event) -> str:
    told = {"number": number, "since": since, **vars(event)}
    return json.dumps(told, ensure_ascii=False, allow_nan=False) + "\n"


def _read_line(line: bytes) -> tuple[dict[str, Any], Event | None]:
    """Its members, none where it is damaged, and its event."""
    try:
        members = json.loads(line) if line.endswith(b"\n") else None
    except ValueError:
        members = None
    if not isinstance(members, dict) or tuple(members) != MEMBERS:
        return {}, None
    if not all(isinstance(members[name], int) for name in MEMBERS[:2]):
        return {}, None
    return members, Event(**{name: members[name] for name in MEMBERS[2:]})


def _sync_folder(folder: Path) -> None:
    """The file's name, too, is on the disk then."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
