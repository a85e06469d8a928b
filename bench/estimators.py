"""What the host's estimators are worth: random trials against the truth (ODO-3, ODO-14).

Each trial makes the true instants of the rising edges of a wheel of constant acceleration, stamps
them at the next tick, and asks the very functions of the host. Windows are 20 ms at 16 MHz.
"""

from __future__ import annotations

import math
from typing import Any

import numba
import numpy as np
from numba.extending import register_jitable

from bench.row import Row, row
from railgate.odometer.host import estimators
from railgate.odometer.host.estimators import Scale
from railgate.odometer.host.feasible import speed_bounds
from railgate.odometer.spec import Assumptions, Config

__all__ = ["run"]

CONFIG = Config()
WINDOW = 320_000
SOURCE_KMH = 0.068
"""The source's error of one period at 200 km/h, km/h."""
CLASSES = ((1, 1), (2, 2), (3, 5), (6, 10), (11, 20), (21, 50), (51, 110))
"""Classes of N - 1, the periods of a window."""

register_jitable(estimators.mean_paces)
mean_paces = numba.njit(estimators.mean_paces)
weighted_paces = numba.njit(estimators.weighted_paces)


@numba.njit
def crossing(place: float, speed: float, acceleration: float) -> float:
    """When a wheel at 0 at time 0 reaches `place`; inf if it never does."""
    root = speed**2 + 2 * acceleration * place
    return 2 * place / (speed + math.sqrt(root)) if root > 0 else math.inf


@numba.njit
def window(speed: float, a: float, tooth: float, stamps: Any, times: Any, off: Any) -> Any:
    """A window's edges: stamps, true times from its start, displacements of the teeth, ± tooth.

    speed, a: in pitches and ticks, at place 0. Returns the place of the first tooth and how many
    periods there are, at least one where the wheel gets so far.
    """
    first, n = np.random.random() + 0.1, -1
    while n + 1 < times.size:
        shift = tooth * (2 * np.random.random() - 1)
        time = crossing(n + 1 + first + shift, speed, a)
        if time == math.inf or (time > WINDOW and n >= 1):
            break
        n += 1
        times[n], off[n], stamps[n] = time, shift, math.ceil(time)
    return first, n


@numba.njit
def omega(stamps: Any, n: int) -> float:
    a = b = 0
    for k in range(1, n + 1):
        a += stamps[k] - stamps[0]
        b += a
    return 6 * ((n + 2) * a - 2 * b) / (n * (n + 1) * (n + 2))


@numba.njit
def scatter(trials: int, first: int, last: int, seed: int) -> float:
    """Ω's mean square error over its theory, 12σ² / (N(N²-1)), at random constant speeds."""
    np.random.seed(seed)
    total, stamps = 0.0, np.empty(last + 1, np.int64)
    for _ in range(trials):
        n = np.random.randint(first, last + 1)
        period, phase = WINDOW / (n + np.random.random()), np.random.random()
        for k in range(n + 1):
            stamps[k] = math.ceil(phase + k * period)
        N = n + 1
        total += (omega(stamps, n) - period) ** 2 * N * (N * N - 1)
    return total / trials


@numba.njit
def violations(
    trials: int, seed: int, slowest: float, fastest: float, a_max: float, tooth: float
) -> Any:
    """How often one period, Π and Ω miss the truth, and how near to a bound it came at most.

    slowest, fastest: greatest and least period, ticks; the speed is uniform between. The truth of
    one period and Π is the mean pace between the teeth's true places, of Ω the weighted mean pace
    between those where they should be.
    """
    np.random.seed(seed)
    times, off, stamps = np.empty(400), np.empty(400), np.empty(400, np.int64)
    missed, near = np.zeros(3, np.int64), np.zeros(3)
    for _ in range(trials):
        speed = 1 / slowest + np.random.random() * (1 / fastest - 1 / slowest)
        a = a_max * (2 * np.random.random() - 1)
        first, n = window(speed, a, tooth, stamps, times, off)
        if n < 1 or crossing(first + n, speed, a) == math.inf:
            continue
        weighted = 0.0
        for k in range(n + 1):
            weighted += (12 * k - 6 * n) * crossing(first + k, speed, a)
        weighted /= n * (n + 1) * (n + 2)
        for which in range(3):
            m = 1 if which == 0 else n
            ticks = stamps[m] - stamps[0]
            if which < 2:
                low, high = mean_paces(m, ticks, tooth)
                truth = (times[m] - times[0]) / (m + off[m] - off[0])
            else:
                low, high = weighted_paces(n, ticks, omega(stamps, n), tooth, a_max)
                truth = weighted
            if not low <= truth <= high:
                missed[which] += 1
            half = (high - low) / 2
            near[which] = max(near[which], abs(truth - low - half) / half)
    return missed, near


@numba.njit
def enclosures(
    trials: int,
    seed: int,
    slowest: float,
    fastest: float,
    a_max: float,
    accelerating: bool,
    tooth: float,
) -> Any:
    """The feasible set's misses, empty sets, mean half-width over Π's, worst error of its middle
    (pitches per tick), and mean half-width (pitches per tick)."""
    np.random.seed(seed)
    times, off, stamps = np.empty(400), np.empty(400), np.empty(400, np.int64)
    missed = empties = 0
    ratio = worst = width = 0.0
    for _ in range(trials):
        speed = 1 / slowest + np.random.random() * (1 / fastest - 1 / slowest)
        a = a_max * (2 * np.random.random() - 1) if accelerating else 0.0
        _, n = window(speed, a, tooth, stamps, times, off)
        if n < 1:
            continue
        low, high, empty = speed_bounds(stamps[: n + 1], tooth, a_max, 0.0)
        truth = speed + a * (stamps[0] + stamps[n] - 1) / 2
        if empty:
            empties += 1
        elif not low <= truth <= high:
            missed += 1
        pace_low, pace_high = mean_paces(n, stamps[n] - stamps[0], tooth)
        ratio += (high - low) / (1 / pace_low - 1 / pace_high)
        worst = max(worst, abs((low + high) / 2 - truth))
        width += (high - low) / 2
    return missed, empties, ratio / trials, worst, width / trials


def _scatter_rows() -> list[Row]:
    rows = []
    for seed, (first, last) in enumerate(CLASSES):
        ratio = scatter(200_000, first, last, seed)
        rows.append(row(f"Ω variance over theory, {first} to {last} periods", ratio))
    worst = max(scatter(100_000, n, n, n) for n in range(1, 110))
    return [*rows, row("Ω variance over theory, worst of N = 2 … 110", worst, most=1.05**2)]


def _violation_rows() -> list[Row]:
    slowest, fastest = CONFIG.period_ticks(3), CONFIG.period_ticks(220)
    missed, trials = np.zeros(3, np.int64), 0
    near = np.zeros(3)
    for seed, tooth in enumerate((0.0, 0.02)):
        scale = Scale(CONFIG, Assumptions(crystal_ppm=0, tooth_error=tooth))
        each = 5_000_000
        some, how_near = violations(each, seed, slowest, fastest, scale.acceleration, tooth)
        missed, trials, near = missed + some, trials + each, np.maximum(near, how_near)
    rows = []
    for name, count, part in zip(("one period", "Π", "Ω"), missed, near, strict=True):
        rows.append(row(f"{name}: violations in {trials:.0e} trials", int(count), most=0))
        rows.append(row(f"{name}: nearest to its bound", float(part), "half-width"))
    return rows


def _feasible_rows() -> list[Row]:
    scale = Scale(CONFIG, Assumptions(crystal_ppm=0))
    slowest, fastest, at_200 = (CONFIG.period_ticks(v) for v in (3, 220, 200))
    args = (scale.acceleration, True)
    missed = empties = trials = 0
    for seed, tooth, each in ((1, 0.0, 7_000_000), (2, 0.001, 1_500_000), (3, 0.02, 1_500_000)):
        some, none, *_ = enclosures(each, seed, slowest, fastest, *args, tooth)
        missed, empties, trials = missed + some, empties + none, trials + each
    rows = [
        row(f"feasible set: violations in {trials:.0e} trials", missed, most=0),
        row("feasible set: empty though all holds", empties, most=0),
    ]
    _, _, ratio, worst, width = enclosures(
        500_000, 4, at_200, at_200, scale.acceleration, False, 0.0
    )
    unit = scale.unit_kmh
    rows += [
        row("feasible set at 200 km/h: times narrower than Π", 1 / ratio, "×", least=10),
        row("feasible set at 200 km/h: mean half-width", width * unit, "km/h"),
        row("feasible set at 200 km/h: worst error", worst * unit, "km/h"),
        row(
            "feasible set at 200 km/h: times below the source's error",
            SOURCE_KMH / (worst * unit),
            "×",
            least=100,
        ),
    ]
    for tooth in (0.0, 0.001, 0.02):
        *_, worst, width = enclosures(100_000, 5, at_200, at_200, *args, tooth)
        what = f"about 200 km/h, ± 1.5 m/s², tooth error {tooth:g}"
        rows.append(row(f"feasible set {what}: mean half-width", width * unit, "km/h"))
        rows.append(row(f"feasible set {what}: worst error", worst * unit, "km/h"))
    return rows


def run() -> list[Row]:
    """The rows of the table: name, value, unit, goal, met."""
    return [*_scatter_rows(), *_violation_rows(), *_feasible_rows()]
