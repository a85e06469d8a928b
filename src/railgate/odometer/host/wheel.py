"""One wheel's speed, window by window, by the estimator of one's choice."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from railgate.odometer.host.estimators import (
    MEAN,
    MIDDLE,
    WEIGHTED,
    Estimate,
    Scale,
    least_squares,
    one_period,
    present,
    reciprocal,
)
from railgate.odometer.host.feasible import feasible
from railgate.odometer.host.readout import Snapshot, Stamps, window_edges
from railgate.odometer.host.tracking import STANDSTILL_S, Axle
from railgate.odometer.spec import Assumptions, Config

__all__ = ["ESTIMATORS", "Wheel"]

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


ESTIMATORS: dict[str, tuple[Estimator, str]] = {
    "period": (_period, MEAN),
    "pi": (_pi, MEAN),
    "omega": (_omega, WEIGHTED),
    "feasible": (_feasible, MIDDLE),
}
"""Estimators by name, and what their interval holds. The last period (the source's), Π, Ω, the
feasible set of all stamps."""


class Wheel:
    """One wheel's speed, window by window, by an estimator of ESTIMATORS. Raises ValueError."""

    def __init__(self, config: Config, assumptions: Assumptions, estimator: str = "pi") -> None:
        if estimator not in ESTIMATORS:
            raise ValueError(f"estimator must be one of {', '.join(ESTIMATORS)}, not {estimator}")
        countable_s = config.period_max / config.clock_hz / 2
        self._axle = Axle(config, assumptions, min(STANDSTILL_S, countable_s))
        self._estimator, _ = ESTIMATORS[estimator]

    def update(self, snapshot: Snapshot, stamps: Stamps | None = None) -> Estimate:
        """The estimate of a window; where it holds no measurement, the interval at the strobe.

        stamps: for `feasible`, holding at least the window's. flags: those of Axle too.
        """
        told = self._axle.update(snapshot)
        estimate = self._estimator(snapshot, stamps, self._axle.scale)
        if estimate.value_kmh is None:
            return told
        return replace(estimate, flags=(*estimate.flags, *told.flags))
