"""The numbers behind the report's charts, as plain lists."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from railgate.unit.report.envelope import Envelope
from railgate.unit.report.lanes import lanes
from railgate.unit.result import Result

__all__ = ["charts"]

POINTS = 6_000
"""Of a line: what a wide screen cannot show all of."""
CUT_PERCENT = 97
"""The chart of what is around the truth is cut where so many of the cycles are inside."""

Floats = NDArray[np.float64]


def charts(result: Result) -> dict[str, Any]:
    """seconds: of the run. each: cycles for two points, 1 for all. times: of the points. speed,
    around, way: the columns of three charts by name. cut: how far the second one reaches. faults,
    lanes: spans."""
    run = result.run
    cycles = run.cycles
    short = Envelope.of(cycles.times_s.size, POINTS)
    shown = lanes(result)
    around, cut = _around(result, short)
    return {
        "seconds": float(run.scenario.seconds),
        "each": short.each,
        "times": _numbers(short.times(cycles.times_s), 4),
        "speed": {
            "truth": _numbers(short.line(cycles.speed_kmh), 3),
            **_interval(short, cycles.low_kmh, cycles.high_kmh, 3),
        },
        "around": around,
        "cut": cut,
        "way": _way(result, short),
        "faults": [span for lane in shown if lane.name.startswith("fault") for span in lane.spans],
        "lanes": [vars(lane) for lane in shown],
    }


def _interval(short: Envelope, low: Floats, high: Floats, digits: int) -> dict[str, Any]:
    """Both ends of FPGA 1's and FPGA 2's."""
    found = {}
    for fpga in (1, 2):
        found[f"low {fpga}"] = _numbers(short.least(low[:, fpga - 1]), digits)
        found[f"high {fpga}"] = _numbers(short.greatest(high[:, fpga - 1]), digits)
    return found


def _around(result: Result, short: Envelope) -> tuple[dict[str, Any], float]:
    """The speed's interval less the true speed."""
    cycles = result.run.cycles
    true = cycles.speed_kmh[:, None]
    low, high = cycles.low_kmh - true, cycles.high_kmh - true
    off = np.abs(np.concatenate([low, high]))
    off = off[np.isfinite(off)]
    cut = float(np.percentile(off, CUT_PERCENT)) if off.size else 1.0
    return _interval(short, low, high, 4), max(cut, 0.01)


def _way(result: Result, short: Envelope) -> dict[str, Any]:
    error = result.way_error_m
    return {f"error {fpga}": _numbers(short.line(error[:, fpga - 1]), 4) for fpga in (1, 2)}


def _numbers(values: Floats, digits: int) -> list[float | None]:
    """As JSON has them: nothing where there is no finite one."""
    found: list[float | None] = np.round(values, digits).tolist()
    if np.isfinite(values).all():
        return found
    return [value if finite else None for value, finite in zip(found, np.isfinite(values), strict=True)]
