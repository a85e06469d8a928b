"""The odometer's host side: registers to speed, direction and distance, in engineering units."""

from railgate.odometer.host.bounds import interval_bounds_s, period_bounds_kmh, phase_bounds_deg
from railgate.odometer.host.calibration import calibrate
from railgate.odometer.host.diameter import WheelRecord, read_wheel, write_wheel
from railgate.odometer.host.estimators import (
    MEAN,
    MIDDLE,
    PRESENT,
    WEIGHTED,
    Estimate,
    Scale,
    least_squares,
    mean_speed,
    one_period,
    present,
    reciprocal,
)
from railgate.odometer.host.feasible import feasible
from railgate.odometer.host.readout import (
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
from railgate.odometer.host.tracking import Axle
from railgate.odometer.host.train import Rolling, Train, TrainState, Verdict
from railgate.odometer.host.wheel import ESTIMATORS, Wheel

__all__ = [
    "ESTIMATORS",
    "MEAN",
    "MIDDLE",
    "PRESENT",
    "WEIGHTED",
    "Axle",
    "Counts",
    "Estimate",
    "Rolling",
    "Scale",
    "Snapshot",
    "Stamps",
    "Train",
    "TrainState",
    "Verdict",
    "Wheel",
    "WheelRecord",
    "between",
    "calibrate",
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
    "read_wheel",
    "reciprocal",
    "snapshots",
    "stamps",
    "window_edges",
    "write_wheel",
]
