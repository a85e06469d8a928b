"""The diameter of a wheel from its steps between two known points (ODO-15)."""

from __future__ import annotations

import math

from railgate.odometer.host.diameter import WheelRecord
from railgate.odometer.host.train import Train

__all__ = ["calibrate"]


def calibrate(train: Train, i: int, distance_m: float, tolerance_m: float, day: str) -> WheelRecord:
    """A new record of axle i, the train having come from its reference to a second known point.

    distance_m: between the two points; tolerance_m: the greatest error of it, of both places and of
    the strobes at which the train is taken to be there. Its bounds rest on that, on the tooth error
    and on the greatest creep. Raises ValueError, also where the axle did not adhere all the way.
    """
    state, wheel = train.state, train.wheels[i]
    if not 0 <= tolerance_m < distance_m < math.inf:
        raise ValueError(
            f"distance_m must be a number above its tolerance {tolerance_m:g}, not {distance_m:g}"
        )
    if not state.rolled[i]:
        raise ValueError(f"axle {wheel.axle} must have adhered since the reference, but did not")
    pitches, seam = abs(state.steps[i]) / 4, 1 + 2 * train.assumptions.tooth_error
    if pitches <= seam:
        raise ValueError(f"axle {wheel.axle} must have turned since the reference, but did not")
    circle, creep = train.config.pulses_per_rev / math.pi, train.rolling.creep
    least = (distance_m - tolerance_m) * (1 - creep) / (pitches + seam) * circle
    greatest = (distance_m + tolerance_m) * (1 + creep) / (pitches - seam) * circle
    return WheelRecord(
        axle=wheel.axle,
        diameter_m=distance_m / pitches * circle,
        least_m=least,
        greatest_m=greatest,
        day=day,
    )
