"""A fault of a run: its kind, when it begins and ends, and a number; as people write it too."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Protocol

from railgate.quantity import span_s, time_s

__all__ = ["TimedFault", "parsed"]

FORM = re.compile(r"\s*([\w-]+)(?::([^@]*))?@(.*)", re.DOTALL)
NUMBER = re.compile(r"\s*-?[0-9]{1,12}\s*")


class Kind(Protocol):
    """value: what the number of such a fault means, empty where it takes none."""

    @property
    def value(self) -> str: ...


@dataclass(frozen=True)
class TimedFault:
    """A kind of fault from a time on until another, or for as long as its kind does by itself.

    Times are in seconds from the run's start. value: None is the kind's default.
    """

    kind: str
    start_s: Fraction
    end_s: Fraction | None = None
    value: int | None = None

    def require(self, kinds: Mapping[str, Kind]) -> None:
        """Raises ValueError unless it is one of these kinds, and can be."""
        _require_kind(self.kind, kinds)
        if self.start_s < 0:
            raise ValueError(
                f"{self.kind} must begin at 0 s at the earliest, not {float(self.start_s):g} s"
            )
        if self.end_s is not None and not self.start_s < self.end_s:
            raise ValueError(
                f"{self.kind} must end after it begins at {float(self.start_s):g} s, "
                f"not at {float(self.end_s):g} s"
            )
        if self.value is not None and not kinds[self.kind].value:
            raise ValueError(f"{self.kind} takes no value, not {self.value}")


def parsed(text: str, kinds: Collection[str]) -> tuple[str, Fraction, Fraction | None, int | None]:
    """The fields of `short@0.1s`, `stuck@60ms..140ms` or `late:40@20ms`. Raises ValueError."""
    found = FORM.fullmatch(text)
    if not found or (found[2] is not None and not NUMBER.fullmatch(found[2])):
        raise ValueError(
            "a fault must be KIND@TIME, KIND@T0..T1 or, with a whole number, KIND:VALUE@TIME, "
            f"KIND of {', '.join(kinds)}, not {text!r}"
        )
    kind, time = found[1], found[3]
    value = None if found[2] is None else int(found[2])
    _require_kind(kind, kinds)
    start, end = span_s(time) if ".." in time else (time_s(time), None)
    return kind, start, end, value


def _require_kind(kind: str, kinds: Collection[str]) -> None:
    if kind not in kinds:
        raise ValueError(f'a fault must be one of {", ".join(kinds)}, not "{kind}"')
