"""A simulated train measured, with the true speed beside each estimate."""

from __future__ import annotations

from dataclasses import replace
from typing import Unpack

import numpy as np

from railgate.odometer.host import MEAN, MIDDLE, WEIGHTED, Estimate, Snapshot
from railgate.odometer.measure import How, Measurement, pin_tick, replay, tell
from railgate.odometer.plant import Floats, Profile, Sensor
from railgate.odometer.spec import Config

__all__ = ["simulate"]


def simulate(profile: Profile, sensor: Sensor, config: Config, **how: Unpack[How]) -> Measurement:
    """Drive the pins from a simulated train and measure; every window has its true speed.

    The true speed is of what the window's interval is guaranteed to hold. Raises ValueError.
    """
    pins = sensor.drive(profile, config)
    replayed = replay(pins, config, **how)
    measured = tell(pins, replayed, **how)
    truth = Truth(profile, sensor, replayed.config, how.get("estimator") == "period")
    told = zip(measured.windows, replayed.shots, replayed.estimates, strict=True)
    windows = [replace(w, true_speed_kmh=truth.of(shot, e)) for w, shot, e in told]
    return replace(measured, windows=tuple(windows))


class Truth:
    """What each estimate should have said, from the train's profile."""

    def __init__(self, profile: Profile, sensor: Sensor, config: Config, last_only: bool) -> None:
        self._profile, self._config, self._last_only = profile, config, last_only
        self._edges = sensor.rises(profile, config, true=True)
        self._places = sensor.rises(profile, config, true=False)

    def of(self, shot: Snapshot, estimate: Estimate) -> float:
        """The true magnitude, km/h, of what `estimate.of` names."""
        last = shot.time - shot.since_rise - self._config.input_delay_ticks
        n, ticks = (1, shot.period) if self._last_only else (shot.window_n, shot.window_ticks)
        end_s, start_s = last / self._config.clock_hz, (last - ticks) / self._config.clock_hz
        if estimate.of == MEAN:
            return self._mean_kmh(start_s, end_s)
        if estimate.of == WEIGHTED:
            return self._weighted_kmh(start_s, end_s, n)
        if estimate.of == MIDDLE:
            return self._at_kmh((start_s + end_s - 1 / self._config.clock_hz) / 2)
        return self._at_kmh(pin_tick(shot, self._config) / self._config.clock_hz)

    def _at_kmh(self, time_s: float) -> float:
        return abs(float(self._profile.speed_kmh(np.array(time_s))))

    def _mean_kmh(self, start_s: float, end_s: float) -> float:
        """Between the true instants of the edges that were stamped then."""
        edges = self._edges[self._backward(start_s, end_s)]
        start_s, end_s = (edges[_nearest(edges, t)] for t in (start_s, end_s))
        start, end = self._profile.position_m(np.array([start_s, end_s]))
        return abs(3.6 * float(end - start) / (end_s - start_s))

    def _weighted_kmh(self, start_s: float, end_s: float, n: int) -> float:
        """Pitch over the parabola-weighted mean of the n periods from the place met at start_s."""
        places = self._places[self._backward(start_s, end_s)]
        first = _nearest(places, start_s)
        times = places[first : first + n + 1]
        if times.size <= n:
            return self._mean_kmh(start_s, end_s)
        weights = 12 * (np.arange(n + 1) - n / 2) / (n * (n + 1) * (n + 2))
        return 3.6 * self._config.pitch_m / float(weights @ (times - start_s))

    def _backward(self, start_s: float, end_s: float) -> int:
        return int(self._profile.speed_kmh(np.array((start_s + end_s) / 2)) < 0)


def _nearest(times_s: Floats, time_s: float) -> int:
    after = int(np.searchsorted(times_s, time_s))
    near = range(max(after - 1, 0), min(after + 1, times_s.size))
    return min(near, key=lambda i: abs(times_s[i] - time_s), default=0)
