"""A train's speed over time, and where it is then.

Ref: source 000, sections 1.1 and 1.2.
"""

from __future__ import annotations

import csv
import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "PROFILES",
    "Floats",
    "Profile",
    "constant",
    "course",
    "ramp",
    "read_profile",
    "run",
    "shuttle",
]

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Profile:
    """A speed over time, linear between its points; negative is reverse.

    times_s: shape (n,), strictly rising from 0, n ≥ 2. speeds_m_s: shape (n,).
    Raises ValueError where this does not hold.
    """

    times_s: Floats
    speeds_m_s: Floats
    _positions_m: Floats = field(init=False, repr=False)

    def __post_init__(self) -> None:
        t, v = np.asarray(self.times_s, float), np.asarray(self.speeds_m_s, float)
        if t.ndim != 1 or t.shape != v.shape or t.size < 2:
            raise ValueError(f"a profile needs at least two points of time and speed, not {t.size}")
        if not (np.isfinite(t).all() and np.isfinite(v).all()):
            raise ValueError("a profile's times and speeds must be finite numbers")
        if t[0] != 0 or not (np.diff(t) > 0).all():
            raise ValueError("a profile's times must rise strictly from 0 s")
        t, v = _split_at_standstill(t, v)
        way = np.concatenate([[0.0], np.cumsum(np.diff(t) * (v[1:] + v[:-1]) / 2)])
        object.__setattr__(self, "times_s", t)
        object.__setattr__(self, "speeds_m_s", v)
        object.__setattr__(self, "_positions_m", way)

    @property
    def duration_s(self) -> float:
        return float(self.times_s[-1])

    def speed_kmh(self, times_s: Floats) -> Floats:
        """The true speed at these times, signed. Shape as `times_s`."""
        return 3.6 * np.interp(times_s, self.times_s, self.speeds_m_s)

    def position_m(self, times_s: Floats) -> Floats:
        """The true way since the start, signed. Shape as `times_s`."""
        t = np.asarray(times_s, float)
        i = np.clip(np.searchsorted(self.times_s, t, side="right") - 1, 0, self.times_s.size - 2)
        dt, v = t - self.times_s[i], self.speeds_m_s
        slope = (v[i + 1] - v[i]) / (self.times_s[i + 1] - self.times_s[i])
        way: Floats = self._positions_m[i] + dt * (v[i] + slope * dt / 2)
        return way

    @property
    def acceleration_m_s2(self) -> float:
        """The greatest magnitude of the acceleration."""
        return float(np.abs(np.diff(self.speeds_m_s) / np.diff(self.times_s)).max())

    def crossings(self, places_m: Floats) -> Floats:
        """The times, rising, at which the train passes places on the line. Shape (crossings,).

        places_m: shape (p,), rising. A place merely touched at a turn is not passed.
        """
        times = [np.empty(0)]
        for first, last in self._stretches():
            way = self._positions_m[first : last + 1]
            forward = way[-1] > way[0]
            low, high = min(way[0], way[-1]), max(way[0], way[-1])
            inside = np.arange(
                np.searchsorted(places_m, low, side="right"),
                np.searchsorted(places_m, high, side="left"),
            )
            inside = inside if forward else inside[::-1]
            times.append(self._reach(places_m[inside], first, last, 1 if forward else -1))
        return np.concatenate(times)

    def _stretches(self) -> list[tuple[int, int]]:
        """Point index ranges in which the train moves one way without rest."""
        way = np.sign(np.diff(self._positions_m))
        turns = np.flatnonzero(np.diff(way)) + 1
        bounds = [0, *turns.tolist(), way.size]
        return [(i, j) for i, j in itertools.pairwise(bounds) if way[i] != 0]

    def _reach(self, places: Floats, first: int, last: int, sign: int) -> Floats:
        """The times of passing `places` in one stretch, from the quadratic of each segment."""
        way = self._positions_m[first : last + 1] * sign
        i = first + np.clip(
            np.searchsorted(way, places * sign, side="right") - 1, 0, last - first - 1
        )
        t, v = self.times_s, self.speeds_m_s * sign
        slope = (v[i + 1] - v[i]) / (t[i + 1] - t[i])
        rest = np.maximum(sign * (places - self._positions_m[i]), 0.0)
        root = np.sqrt(np.maximum(v[i] ** 2 + 2 * slope * rest, 0.0))
        speed = np.maximum(v[i] + root, np.finfo(float).tiny)
        reached: Floats = np.minimum(t[i] + 2 * rest / speed, t[i + 1])
        return reached


def _split_at_standstill(t: Floats, v: Floats) -> tuple[Floats, Floats]:
    """Add a point wherever the speed passes through 0 between two points."""
    turns = np.flatnonzero(v[1:] * v[:-1] < 0)
    at = t[turns] + (t[turns + 1] - t[turns]) * v[turns] / (v[turns] - v[turns + 1])
    return np.insert(t, turns + 1, at), np.insert(v, turns + 1, 0.0)


def constant(speed_kmh: float, seconds: float) -> Profile:
    """One speed throughout."""
    return Profile(np.array([0.0, seconds]), np.array([speed_kmh, speed_kmh]) / 3.6)


def ramp(speed_kmh: float, seconds: float) -> Profile:
    """From rest to the speed, at constant acceleration over the whole time."""
    return Profile(np.array([0.0, seconds]), np.array([0.0, speed_kmh]) / 3.6)


def run(speed_kmh: float, seconds: float) -> Profile:
    """From stop to stop: up over three eighths, along at the speed, down over three eighths.

    Speeding up and braking follow a raised cosine, so that acceleration has no steps.
    """
    t = np.linspace(0.0, seconds, 1 + max(64, math.ceil(100 * seconds)))
    part = np.minimum(np.minimum(t, seconds - t) / (seconds * 3 / 8), 1.0)
    return Profile(t, speed_kmh / 3.6 * (1 - np.cos(np.pi * part)) / 2)


def shuttle(speed_kmh: float, seconds: float) -> Profile:
    """Forward, to rest, and back to where it began."""
    t = np.linspace(0.0, seconds, 1 + max(64, math.ceil(100 * seconds)))
    return Profile(t, speed_kmh / 3.6 * np.sin(2 * np.pi * t / seconds))


PROFILES: dict[str, Callable[[float, float], Profile]] = {
    "constant": constant,
    "ramp": ramp,
    "run": run,
    "shuttle": shuttle,
}
"""Built-in profiles by name: (speed in km/h, seconds) -> Profile."""


def course(name: str, speed_kmh: float, seconds: float) -> Profile:
    """A built-in profile by its name, else the profile in the file of that name."""
    if name not in PROFILES:
        if not Path(name).exists():
            raise ValueError(f"a profile must be {', '.join(PROFILES)} or a file, not {name}")
        return read_profile(Path(name))
    if not 0 < seconds <= 86_400:
        raise ValueError(f"seconds must be above 0 and at most 86400, not {seconds:g}")
    return PROFILES[name](speed_kmh, seconds)


def read_profile(path: Path) -> Profile:
    """A profile from a CSV file with the columns time_s, speed_kmh. Raises ValueError."""
    try:
        with path.open(newline="", encoding="utf-8") as file:
            header, *rows = [row for row in csv.reader(file) if row] or [[]]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise ValueError(f"{path} cannot be read as a profile: {error}") from None
    if [name.strip() for name in header] != ["time_s", "speed_kmh"]:
        raise ValueError(
            f"{path} must have the columns time_s,speed_kmh, not {','.join(header) or 'none'}"
        )
    points = []
    for line, row in enumerate(rows, start=2):
        try:
            time, speed = map(float, row)
        except ValueError:
            raise ValueError(
                f"{path}, line {line}: two numbers are needed, not {','.join(row)}"
            ) from None
        points.append((time, speed / 3.6))
    t, v = np.array(points, float).reshape(-1, 2).T
    try:
        return Profile(t, v)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
