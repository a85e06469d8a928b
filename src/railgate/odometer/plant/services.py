"""What trains do: how fast, how hard, how often they stop (ODO-15).

The figures are assumed, round ones of the usual order; none is one train's. Freight: 300 kN before
2 000 t make 0.15 m/s².
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from railgate.odometer.plant.profile import Profile

__all__ = ["SERVICES", "Service"]

BUILD_UP_S = 1.0
"""In which a brake or a traction effort comes up and goes: jerk below the 1 m/s³ of comfort."""


@dataclass(frozen=True, kw_only=True)
class Service:
    """speed_kmh: between stops. traction, braking: m/s², of the train and greatest. weak: part of
    the traction that is left above half the speed. cruise_s, dwell_s: at speed, and at each stop.
    driven: part of the train's mass on driven axles, of which the first is one. hops: from stop to
    stop."""

    speed_kmh: float
    traction: float
    weak: float
    braking: float
    cruise_s: float
    dwell_s: float
    driven: float
    hops: int

    def profile(
        self, braking: float | None = None
    ) -> tuple[Profile, list[tuple[str, float, float]]]:
        """The train's speed, and where it pulls and brakes: (what, from s, to s), in order.

        braking: what the rail lets through of the service's.
        """
        times, speeds, phases = [0.0, self.dwell_s / 2], [0.0, 0.0], []
        top = self.speed_kmh / 3.6
        for _ in range(self.hops):
            start = times[-1]
            _change(times, speeds, top / 2, self.traction)
            _change(times, speeds, top, self.traction * self.weak)
            phases.append(("traction", start, times[-1]))
            times.append(times[-1] + self.cruise_s)
            speeds.append(top)
            start = times[-1]
            _change(times, speeds, 0.0, -(braking or self.braking))
            phases.append(("braking", start, times[-1]))
            times.append(times[-1] + self.dwell_s)
            speeds.append(0.0)
        return Profile(np.array(times), np.array(speeds)), phases


def _change(times: list[float], speeds: list[float], speed: float, acceleration: float) -> None:
    """On to another speed; the effort comes up and goes in four steps each."""
    steps = np.array([1, 2, 3, 4]) / 5
    seconds = BUILD_UP_S / 4
    lost = acceleration * seconds * steps.sum()
    rest = (speed - speeds[-1] - 2 * lost) / acceleration
    for part, length in [
        *((s, seconds) for s in steps),
        (1.0, rest),
        *((s, seconds) for s in steps[::-1]),
    ]:
        times.append(times[-1] + length)
        speeds.append(speeds[-1] + part * acceleration * length)
    speeds[-1] = speed


SERVICES = {
    "metro": Service(
        speed_kmh=80,
        traction=1.1,
        weak=0.6,
        braking=1.1,
        cruise_s=20,
        dwell_s=25,
        driven=0.5,
        hops=3,
    ),
    "long-distance": Service(
        speed_kmh=200,
        traction=0.5,
        weak=0.5,
        braking=0.7,
        cruise_s=120,
        dwell_s=60,
        driven=0.4,
        hops=1,
    ),
    "freight": Service(
        speed_kmh=90,
        traction=0.15,
        weak=0.6,
        braking=0.4,
        cruise_s=120,
        dwell_s=60,
        driven=0.05,
        hops=1,
    ),
}
