"""The odometer's host side: registers to speed, direction and distance, in engineering units."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from railgate.odometer.bounds import interval_bounds_s, period_bounds_kmh, phase_bounds_deg
from railgate.odometer.estimators import (
    Estimate,
    Scale,
    least_squares,
    mean_speed,
    one_period,
    present,
    reciprocal,
)
from railgate.odometer.feasible import feasible
from railgate.odometer.readout import (
    Counts,
    Snapshot,
    Stamps,
    between,
    direction,
    distance_m,
    phase_deg,
    snapshots,
    stamps,
    window_edges,
)
from railgate.odometer.spec import Assumptions, Config
from railgate.odometer.tracking import Axle, Train, TrainSpeed

__all__ = [
    "ESTIMATORS",
    "Axle",
    "Counts",
    "Estimate",
    "Scale",
    "Snapshot",
    "Stamps",
    "Train",
    "TrainSpeed",
    "Wheel",
    "between",
    "direction",
    "distance_m",
    "feasible",
    "interval_bounds_s",
    "least_squares",
    "mean_speed",
    "one_period",
    "period_bounds_kmh",
    "phase_bounds_deg",
    "phase_deg",
    "present",
    "reciprocal",
    "snapshots",
    "stamps",
    "window_edges",
]

Estimator = Callable[[Snapshot, Stamps | None, Scale], Estimate]


def _period(snapshot: Snapshot, _: Stamps | None, scale: Scale) -> Estimate:
    """Only a period that ended in the window speaks of it."""
    return one_period(snapshot, scale) if snapshot.pulses else present(snapshot, scale)


def _pi(snapshot: Snapshot, _: Stamps | None, scale: Scale) -> Estimate:
    return reciprocal(snapshot, scale)


def _omega(snapshot: Snapshot, _: Stamps | None, scale: Scale) -> Estimate:
    return least_squares(snapshot, scale)


def _feasible(snapshot: Snapshot, stamps: Stamps | None, scale: Scale) -> Estimate:
    """From the window's stamps; where they are incomplete Π, flagged `stamps_missing`."""
    if not snapshot.window_n:
        return present(snapshot, scale)
    edges = None if stamps is None else window_edges(stamps, snapshot, scale.config)
    if edges is None:
        return replace(reciprocal(snapshot, scale), flags=("stamps_missing",))
    return feasible(edges, scale)


ESTIMATORS: dict[str, Estimator] = {
    "period": _period,
    "pi": _pi,
    "omega": _omega,
    "feasible": _feasible,
}
"""The estimators by name: the last period (the source's), Π, Ω, the feasible set of all stamps."""


class Wheel:
    """One wheel's speed, window by window, by an estimator of ESTIMATORS. Raises ValueError."""

    def __init__(self, config: Config, assumptions: Assumptions, estimator: str = "pi") -> None:
        if estimator not in ESTIMATORS:
            raise ValueError(f"estimator must be one of {', '.join(ESTIMATORS)}, not {estimator}")
        self._axle = Axle(config, assumptions)
        self._estimator = ESTIMATORS[estimator]

    def update(self, snapshot: Snapshot, stamps: Stamps | None = None) -> Estimate:
        """The estimate of a window; where it holds no measurement, the interval at the strobe.

        stamps: for `feasible`, holding at least the window's. flags: those of Axle too.
        """
        told = self._axle.update(snapshot)
        estimate = self._estimator(snapshot, stamps, self._axle.scale)
        if estimate.value_kmh is None:
            return told
        return replace(estimate, flags=(*estimate.flags, *told.flags))
