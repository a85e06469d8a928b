"""Where a train runs and stops: a route, its speed profile, its calls at platforms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from itertools import pairwise
from math import sqrt

import numpy as np

from railgate.bounds import require
from railgate.odometer.plant import Profile

__all__ = ["Call", "Route", "Side", "Stop"]


class Side(Enum):
    """The platform's, and which output of the unit releases the doors there."""

    LEFT = 0
    RIGHT = 1


@dataclass(frozen=True, kw_only=True)
class Stop:
    """A platform: its place on the line, its side, how long the train stands there."""

    at_m: float
    side: Side = Side.RIGHT
    dwell_s: float = 20.0

    def __post_init__(self) -> None:
        require(self, ("at_m", 0, 1_000_000), ("dwell_s", 1, 3_600))


@dataclass(frozen=True)
class Call:
    """A stop, and when the train has come to rest there and leaves again, s."""

    stop: Stop
    arrives_s: float
    departs_s: float


@dataclass(frozen=True, kw_only=True)
class Route:
    """A train that calls at stops in the order of their places, the first one where it begins.

    Between two of them it speeds up at acceleration_m_s2 to at most speed_kmh and brakes at
    braking_m_s2. Raises ValueError.
    """

    stops: Sequence[Stop]
    speed_kmh: float = 80.0
    acceleration_m_s2: float = 1.0
    braking_m_s2: float = 1.0

    def __post_init__(self) -> None:
        require(
            self,
            ("speed_kmh", 1, 600),
            ("acceleration_m_s2", 0.05, 5),
            ("braking_m_s2", 0.05, 5),
        )
        if len(self.stops) < 2:
            raise ValueError(f"stops must be at least 2, not {len(self.stops)}")
        for here, there in pairwise(self.stops):
            if not here.at_m < there.at_m:
                raise ValueError(
                    f"stops must be in order of place, not {there.at_m:g} m after {here.at_m:g} m"
                )

    @property
    def start_m(self) -> float:
        """Where the run begins."""
        return self.stops[0].at_m

    @cached_property
    def calls(self) -> tuple[Call, ...]:
        """One for each stop."""
        time, calls = 0.0, list[Call]()
        for stop in self.stops:
            if calls:
                time = calls[-1].departs_s + sum(self._leg(stop.at_m - calls[-1].stop.at_m)[:3])
            calls.append(Call(stop, time, time + stop.dwell_s))
        return tuple(calls)

    def profile(self) -> Profile:
        """Speed over time, from the first stop's dwell to the last one's end."""
        points = [(0.0, 0.0)]
        for call, after in pairwise(self.calls):
            up, along, down, speed = self._leg(after.stop.at_m - call.stop.at_m)
            steps = ((call.departs_s, 0.0), (up, speed), (along, speed), (down, 0.0))
            time = 0.0
            for step, at in steps:
                time += step
                if time > points[-1][0]:
                    points.append((time, at))
        points.append((self.calls[-1].departs_s, 0.0))
        return Profile(*np.array(points).T)

    def _leg(self, way_m: float) -> tuple[float, float, float, float]:
        """Seconds of speeding up, of running along and of braking, and the speed, m/s."""
        up, down = self.acceleration_m_s2, self.braking_m_s2
        speed = min(self.speed_kmh / 3.6, sqrt(2 * way_m * up * down / (up + down)))
        along = way_m / speed - speed / (2 * up) - speed / (2 * down)
        return speed / up, max(along, 0.0), speed / down, speed
