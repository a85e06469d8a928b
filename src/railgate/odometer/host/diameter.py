"""Wheel diameters as persistent data (ODO-16).

A record is a JSON object of the fields of WheelRecord and `checksum`, the SHA-256 of the others in
canonical form. One that is missing, damaged, beyond its limits or another axle's is an error, never
a default.
"""

from __future__ import annotations

import datetime
import hashlib
import json
import math
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from railgate.bounds import require
from railgate.waves import replacing

__all__ = ["WheelRecord", "read_wheel", "write_wheel"]


@dataclass(frozen=True, kw_only=True)
class WheelRecord:
    """The diameter of one axle's wheels, metres. Raises ValueError.

    axle: its name. diameter_m: the best figure, least_m … greatest_m: where it certainly lies. day:
    of the measurement, YYYY-MM-DD.
    """

    axle: str
    diameter_m: float
    least_m: float
    greatest_m: float
    day: str

    def __post_init__(self) -> None:
        for name in ("diameter_m", "least_m", "greatest_m"):
            if type(value := getattr(self, name)) is not float or not math.isfinite(value):
                raise ValueError(f"{name} must be a number with a decimal point, not {value!r}")
        require(self, ("least_m", 0.01, 10), ("greatest_m", self.least_m, 10))
        require(self, ("diameter_m", self.least_m, self.greatest_m))
        try:
            datetime.date.fromisoformat(self.day)
        except (TypeError, ValueError):
            raise ValueError(f"day must be a date YYYY-MM-DD, not {self.day!r}") from None


def write_wheel(path: Path, record: WheelRecord) -> None:
    """Write a record's file; it is there whole or not. Raises ValueError."""
    content = {**asdict(record), "checksum": _checksum(asdict(record))}
    with replacing(path) as new:
        new.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


def read_wheel(path: Path, axle: str, limits_m: tuple[float, float]) -> WheelRecord:
    """The record of an axle. Raises ValueError where it is missing, damaged or another axle's.

    limits_m: the least diameter at which the wheel may run, and that of a new one.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ValueError(f"{path} cannot be read as a wheel's record: {error}") from None
    names = {field.name for field in fields(WheelRecord)} | {"checksum"}
    if not isinstance(content, dict) or set(content) != names:
        raise ValueError(f"{path} must hold the fields {', '.join(sorted(names))}, and only these")
    checksum = content.pop("checksum")
    if checksum != _checksum(content):
        raise ValueError(f"{path} is damaged: its checksum is not that of its fields")
    try:
        record = WheelRecord(**content)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    if record.axle != axle:
        raise ValueError(f"{path} must be of axle {axle}, not {record.axle}")
    worn, new = limits_m
    if not worn <= record.least_m <= record.greatest_m <= new:
        raise ValueError(
            f"{path}: a diameter must lie within {worn:g} m and {new:g} m, "
            f"not {record.least_m:g} … {record.greatest_m:g} m"
        )
    return record


def _checksum(content: dict[str, Any]) -> str:
    canonical = json.dumps(content, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(canonical.encode()).hexdigest()
