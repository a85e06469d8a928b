"""The numbers behind the report's charts, as plain lists."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from railgate.unit.report.envelope import Envelope
from railgate.unit.report.lanes import lanes
from railgate.unit.result import Result
from railgate.unit.run import Cycles

__all__ = ["charts"]

POINTS = 6_000
"""Of a line: what a wide screen cannot show all of."""
MOST_CYCLES, BEYOND = 95, 3.0
"""Percent of the cycles that the chart about the truth has room for, so many times over: one cycle
may have an interval that would make a line of all others."""

Floats = NDArray[np.float64]


def charts(result: Result) -> dict[str, Any]:
    """seconds: of the run. each: cycles for two points, 1 for all. times: of the points. speed,
    around, way: the columns of three charts by name. cut: how far the second one reaches. faults,
    lanes: spans."""
    run = result.run
    cycles = run.cycles
    short = Envelope.of(cycles.times_s.size, POINTS)
    shown = lanes(result)
    around, cut = _around(cycles, short)
    way = (cycles.place_m - run.scenario.route.start_m)[:, None]
    error = cycles.way_m - way
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
        "way": {
            **{f"error {fpga}": _numbers(short.line(error[:, fpga - 1]), 4) for fpga in (1, 2)},
            **_interval(short, cycles.way_low_m - way, cycles.way_high_m - way, 4),
        },
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


def _around(cycles: Cycles, short: Envelope) -> tuple[dict[str, Any], float]:
    """The speed's interval less the true speed, and how far it reaches."""
    true = cycles.speed_kmh[:, None]
    low, high = cycles.low_kmh - true, cycles.high_kmh - true
    reach = np.abs(np.concatenate([low, high]))
    reach = reach[np.isfinite(reach)]
    cut = min(reach.max(), BEYOND * float(np.percentile(reach, MOST_CYCLES)))
    return _interval(short, low, high, 4), max(cut, 0.01)


def _numbers(values: Floats, digits: int) -> list[float | None]:
    """As JSON has them: nothing where there is no finite one."""
    found: list[float | None] = np.round(values, digits).tolist()
    if np.isfinite(values).all():
        return found
    there = np.isfinite(values).tolist()
    return [value if is_there else None for value, is_there in zip(found, there, strict=True)]
