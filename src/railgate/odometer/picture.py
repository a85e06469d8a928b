"""A measurement as a picture: speed with its bound, direction, distance, events."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from railgate.odometer.measure import Measurement
from railgate.odometer.spec import Flag
from railgate.waves import replacing

__all__ = ["draw"]

Floats = NDArray[np.float64]

BLUE, ORANGE, GREY, RED = "#2a6fbb", "#d9822b", "#8a8f98", "#c23b3b"


def draw(measurement: Measurement, path: Path) -> None:
    """Draw into a PNG file, which is there whole or not. Raises ValueError."""
    figure = Figure(figsize=(11, 9.5), layout="constrained", dpi=110)
    flags = sorted({flag for window in measurement.windows for flag in window.flags})
    heights = (3.0, 1.2, 0.6, 1.4, 0.3 + 0.2 * max(1, len(flags)))
    axes = figure.subplots(len(heights), 1, sharex=True, height_ratios=heights)
    times = np.array([window.t_s for window in measurement.windows])
    _speed(axes[0], measurement, times)
    _bound(axes[1], measurement, times)
    _direction(axes[2], measurement, times)
    _distance(axes[3], measurement, times)
    _events(axes[4], measurement, times, flags)
    axes[-1].set_xlabel("time / s")
    for ax in axes:
        ax.grid(alpha=0.25)
        ax.spines[["top", "right"]].set_visible(False)
        ax.margins(x=0.01)
    figure.align_ylabels(axes)
    figure.suptitle(
        f"{measurement.position_x4:+d} quarter pitches, {measurement.distance_m:+.3f} m "
        f"in {measurement.duration_s:g} s  ·  {measurement.engine}, "
        f"{measurement.clock_hz / 1e6:g} MHz, {measurement.estimator}",
        fontsize=11,
    )
    with replacing(path) as new:
        figure.savefig(new, format="png")


def _speed(ax: Axes, measurement: Measurement, times: Floats) -> None:
    low, speed, high, true = _speeds(measurement)
    ax.fill_between(
        times, low, high, color=BLUE, alpha=0.22, lw=0, label="guaranteed interval", step="pre"
    )
    dots = "." if len(times) < 400 else ""
    ax.plot(times, speed, dots + "-", color=BLUE, ms=3, lw=1, label="measured")
    if np.isfinite(true).any():
        ax.plot(times, true, "--", color=ORANGE, lw=1, label="true")
    ax.set_ylabel("speed / km/h")
    seen = np.concatenate([speed, true])
    top = np.nanmax(seen if np.isfinite(seen).any() else [*high, 1.0])
    ax.set_ylim(0, 1.15 * max(top, 1.0))  # a bound that says next to nothing may leave the picture
    ax.legend(loc="upper right", fontsize=8, frameon=False, ncols=3)


def _bound(ax: Axes, measurement: Measurement, times: Floats) -> None:
    """The interval and the truth about the measured speed, which is the line at 0."""
    low, speed, high, true = _speeds(measurement)
    ax.fill_between(times, low - speed, high - speed, color=BLUE, alpha=0.22, lw=0, step="pre")
    ax.axhline(0, color=BLUE, lw=1)
    ax.plot(times, true - speed, color=ORANGE, lw=1)
    reach = np.concatenate([high - speed, speed - low])
    reach = reach[np.isfinite(reach)]
    most = 1.3 * float(np.quantile(reach, 0.98)) if reach.size else 1.0
    ax.set_ylim(-most, most)
    ax.set_ylabel("bound / km/h")


def _speeds(measurement: Measurement) -> tuple[Floats, Floats, Floats, Floats]:
    """Low, measured, high and true speed of each window; NaN where there is none."""
    rows = [
        (w.speed_low_kmh, w.speed_kmh, w.speed_high_kmh, w.true_speed_kmh)
        for w in measurement.windows
    ]
    low, speed, high, true = np.array(rows, float).T
    return low, speed, high, true


def _direction(ax: Axes, measurement: Measurement, times: Floats) -> None:
    code = {"reverse": -1, "none": 0, "forward": 1}
    values = [code[window.direction] for window in measurement.windows]
    ax.step(times, values, where="pre", color=BLUE, lw=1)
    ax.set_yticks([-1, 0, 1], ["reverse", "none", "forward"])
    ax.set_ylim(-1.4, 1.4)
    ax.set_ylabel("direction")


def _distance(ax: Axes, measurement: Measurement, times: Floats) -> None:
    ax.plot(times, measurement.distances_m, color=BLUE, lw=1.2)
    ax.set_ylabel("distance / m")


def _events(ax: Axes, measurement: Measurement, times: Floats, flags: list[str]) -> None:
    faults = {flag.name.lower() for flag in Flag if flag.name} - {"reversal", "window_void"}
    for row, flag in enumerate(flags):
        at = [t for t, w in zip(times, measurement.windows, strict=True) if flag in w.flags]
        color = RED if flag in faults else GREY
        ax.plot(at, [row] * len(at), "|", color=color, ms=7, mew=1.2)
    ax.set_yticks(range(len(flags)), [flag.replace("_", " ") for flag in flags], fontsize=8)
    ax.set_ylim(max(len(flags), 1) - 0.5, -0.5)
    ax.set_ylabel("events")
