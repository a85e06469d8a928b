"""A two-channel wheel sensor: its edges over a wheel's motion. Ref: source 000, section 2.1."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from railgate.bounds import require
from railgate.odometer.plant.profile import Floats, Profile
from railgate.odometer.spec import Config
from railgate.waves import Trace, Waveform
from railgate.waves.waveform import Ticks

__all__ = ["Channel", "Passed", "Sensor"]

MOST_PITCHES = 10_000_000
"""Of one run: some hundred kilometres."""


class Passed(NamedTuple):
    """What has passed a sensor, each (ticks,): rising edges of a and of b, steps in ¼ pitch,
    the pins' tick of the last rising edge of a and of the last edge, 0 before the first."""

    rises: Ticks
    b_rises: Ticks
    steps: Ticks
    last_rise: Ticks
    last_edge: Ticks


@dataclass(frozen=True, eq=False)
class Channel:
    """One channel's level at the start, and the times at which it changes, s, rising."""

    level: int
    changes_s: Floats

    def wave(self, clock_hz: float, end: int) -> Waveform:
        """Its pin in ticks of a clock, below `end`."""
        ticks = np.ceil(self.changes_s * clock_hz).astype(np.int64)
        ticks = np.concatenate([[0], ticks[: np.searchsorted(ticks, end)]])
        return Waveform.of(ticks, (np.arange(ticks.size) + self.level) & 1)


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
        end = math.ceil(profile.duration_s * config.clock_hz)
        channels = {
            name: channel.wave(config.clock_hz, end)
            for name, channel in self.channels(profile, config).items()
        }
        return Trace(channels, Fraction(1, config.clock_hz), 0, end)

    def channels(self, profile: Profile, config: Config) -> dict[str, Channel]:
        """What a and b do over the profile, whatever the clock."""
        random, found = self._random(), {}
        for name, lag, dead_s in (
            ("a", 0.0, self.a_dead_s),
            ("b", self.phase_deg / 360, self.b_dead_s),
        ):
            high, toggles = self._toggles(profile, config, lag, random)
            toggles = self._disturb(toggles, profile.duration_s, random)
            found[name] = Channel(high, np.sort(toggles[toggles < dead_s], kind="stable"))
        return found

    def rises(self, profile: Profile, config: Config, true: bool) -> tuple[Floats, Floats]:
        """When A rises, s, rising: in the stretches run forward, and in those in reverse.

        true: with the tooth errors, else where each edge should be. Jitter and disturbances are
        left out.
        """
        places = self._places(profile, config, 0.0, self._random(), true)
        forward, reverse = (places[:, edge] - self.offset for edge in range(2))
        pitch = config.pitch_m
        return profile.crossings(forward * pitch), profile.crossings(reverse * pitch)

    def passed(self, profile: Profile, config: Config, ticks: Ticks) -> Passed:
        """What has passed the sensor by these ticks of the pins, without making every edge.

        Exactly that of `drive`, for a wheel that never runs back and a sensor without jitter and
        disturbances. ticks: int64, rising.
        """
        random, kinds = self._random(), []
        for lag in (0.0, self.phase_deg / 360):
            errors = self._errors(config, random)
            for edge in range(2):
                base = lag + self.duty * edge
                kinds.append(self._last(profile, config, base, errors[:, edge], ticks))
        counts, lasts = np.array(kinds).transpose(1, 0, 2)
        return Passed(counts[0], counts[2], counts.sum(axis=0), lasts[0], lasts.max(axis=0))

    def _last(
        self, profile: Profile, config: Config, base: float, errors: Floats, ticks: Ticks
    ) -> tuple[Ticks, Ticks]:
        """Of edges at base + errors[k] in every pitch k: how many by each tick, and the last's."""
        here = profile.position_m(ticks / config.clock_hz) / config.pitch_m + self.offset
        end = float(profile.position_m(profile.times_s[-1:])[0]) / config.pitch_m + self.offset
        near = math.floor(self.offset - base) + np.arange(-1, 3)
        first = near[near + base + errors[near % errors.size] > self.offset][0]
        count, last = np.zeros_like(ticks), np.zeros_like(ticks)
        for k in (np.floor(here - base).astype(np.int64) + step for step in (-1, 0, 1)):
            places, at = np.unique(k + base + errors[k % errors.size], return_inverse=True)
            inside = (places > self.offset) & (places < end)
            times = np.full(places.size, np.iinfo(np.int64).max)
            met = profile.crossings((places[inside] - self.offset) * config.pitch_m)
            times[inside] = np.ceil(met * config.clock_hz).astype(np.int64)
            passed = times[at] <= ticks
            count, last = np.where(passed, k - first + 1, count), np.where(passed, times[at], last)
        return count, last

    def _random(self) -> np.random.Generator:
        return np.random.default_rng(self.seed)

    def _toggles(
        self, profile: Profile, config: Config, lag: float, random: np.random.Generator
    ) -> tuple[int, Floats]:
        """One channel's level at the start and the times of its changes, without disturbances."""
        places = self._places(profile, config, lag, random, True).ravel()
        times = profile.crossings((np.sort(places, kind="stable") - self.offset) * config.pitch_m)
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
        errors = self._errors(config, random)
        places: Floats = teeth[:, None] + lag + np.array([0.0, self.duty])
        return places + errors[teeth % config.pulses_per_rev] if true else places

    def _errors(self, config: Config, random: np.random.Generator) -> Floats:
        """How far each tooth's rise and fall are off, pitches: shape (pulses_per_rev, 2)."""
        shape = (config.pulses_per_rev, 2)
        return random.uniform(-self.tooth_error, self.tooth_error, shape)

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
