"""What is outside the odometer's pins: a train's speed profile, a wheel, a two-channel sensor.

Ref: source 000, sections 1.1, 1.2 and 2.1; ODO-1.
"""

from __future__ import annotations

import csv
import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from railgate.bounds import require
from railgate.odometer.spec import Config
from railgate.waves import Trace, Waveform

__all__ = [
    "PROFILES",
    "Floats",
    "Profile",
    "Sensor",
    "constant",
    "course",
    "ramp",
    "read_profile",
    "run",
    "shuttle",
]

Floats = NDArray[np.float64]

MOST_PITCHES = 10_000_000
"""Of one run: some hundred kilometres."""


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


@dataclass(frozen=True, kw_only=True)
class Sensor:
    """A two-channel wheel sensor and its imperfections.

    duty: high part of a pitch. phase_deg: how far B lags A, forward. offset: where the wheel stands
    at the start, pitches. tooth_error: greatest random displacement of each edge of each tooth,
    pitches, the same in every revolution. jitter_s: greatest random delay of each edge, s.
    dropouts: part of the pulses of each channel that are lost. glitches_hz, glitch_s: rate and
    length of stray pulses on each channel. a_dead_s, b_dead_s: the time from which the channel
    holds its level. seed: of all that is random.
    """

    duty: float = 0.5
    phase_deg: float = 90.0
    offset: float = 0.1
    tooth_error: float = 0.0
    jitter_s: float = 0.0
    dropouts: float = 0.0
    glitches_hz: float = 0.0
    glitch_s: float = 1e-6
    a_dead_s: float = math.inf
    b_dead_s: float = math.inf
    seed: int = 0

    def __post_init__(self) -> None:
        require(
            self,
            ("duty", 0.05, 0.95),
            ("phase_deg", 1, 359),
            ("tooth_error", 0, 0.25),
            ("jitter_s", 0, 1),
            ("dropouts", 0, 1),
            ("glitches_hz", 0, 1e6),
            ("glitch_s", 1e-9, 1),
        )

    def drive(self, profile: Profile, config: Config) -> Trace:
        """The pins over the profile: signals a, b in ticks of the configuration's clock.

        A change is seen at the first tick that does not begin before it.
        """
        period = Fraction(1, config.clock_hz)
        end = math.ceil(profile.duration_s * config.clock_hz)
        random = self._random()
        channels = {}
        for name, lag, dead_s in (
            ("a", 0.0, self.a_dead_s),
            ("b", self.phase_deg / 360, self.b_dead_s),
        ):
            high, toggles = self._toggles(profile, config, lag, random)
            toggles = self._disturb(toggles, profile.duration_s, random)
            ticks = np.ceil(np.sort(toggles[toggles < dead_s]) * config.clock_hz).astype(np.int64)
            ticks = np.concatenate([[0], ticks[ticks < end]])
            channels[name] = Waveform.of(ticks, (np.arange(ticks.size) + high) & 1)
        return Trace(channels, period, 0, end)

    def rises(self, profile: Profile, config: Config, true: bool) -> tuple[Floats, Floats]:
        """When A rises, s, rising: in the stretches run forward, and in those in reverse.

        true: with the tooth errors, else where each edge should be. Jitter and disturbances are
        left out.
        """
        places = self._places(profile, config, 0.0, self._random(), true)
        forward, reverse = (places[:, edge] - self.offset for edge in range(2))
        pitch = config.pitch_m
        return profile.crossings(forward * pitch), profile.crossings(reverse * pitch)

    def _random(self) -> np.random.Generator:
        return np.random.default_rng(self.seed)

    def _toggles(
        self, profile: Profile, config: Config, lag: float, random: np.random.Generator
    ) -> tuple[int, Floats]:
        """One channel's level at the start and the times of its changes, without disturbances."""
        places = self._places(profile, config, lag, random, True).ravel()
        times = profile.crossings((np.sort(places) - self.offset) * config.pitch_m)
        behind = int(np.count_nonzero(places <= self.offset))
        return behind & 1, times

    def _places(
        self,
        profile: Profile,
        config: Config,
        lag: float,
        random: np.random.Generator,
        true: bool,
    ) -> Floats:
        """Where a channel rises and falls, going forward, in pitches: shape (teeth, 2)."""
        teeth = self._teeth(profile, config.pitch_m)
        errors = random.uniform(-self.tooth_error, self.tooth_error, (config.pulses_per_rev, 2))
        places: Floats = teeth[:, None] + lag + np.array([0.0, self.duty])
        return places + errors[teeth % config.pulses_per_rev] if true else places

    def _teeth(self, profile: Profile, pitch: float) -> NDArray[np.int64]:
        """The teeth from just before the wheel's least to just after its greatest place."""
        way = profile.position_m(profile.times_s) / pitch + self.offset
        if way.max() - way.min() > MOST_PITCHES:
            raise ValueError(
                f"a run must be at most {MOST_PITCHES} pitches long, "
                f"not {way.max() - way.min():.0f}"
            )
        return np.arange(math.floor(way.min()) - 3, math.ceil(way.max()) + 3)

    def _disturb(self, toggles: Floats, seconds: float, random: np.random.Generator) -> Floats:
        """Jitter, lost pulses and stray pulses."""
        if self.jitter_s:
            toggles = toggles + random.uniform(0, self.jitter_s, toggles.size)
        if self.dropouts:
            pairs = random.random(toggles.size // 2) >= self.dropouts
            keep = np.append(np.repeat(pairs, 2), np.full(toggles.size % 2, True))
            toggles = np.sort(toggles)[keep]
        if self.glitches_hz:
            at = random.uniform(0, seconds, random.poisson(self.glitches_hz * seconds))
            toggles = np.concatenate([toggles, at, at + self.glitch_s])
        return toggles
