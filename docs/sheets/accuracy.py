"""What a measurement of the odometer is good for, by the host's own functions and by runs."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from railgate.odometer.host import (
    ESTIMATORS,
    interval_bounds_s,
    period_bounds_kmh,
    phase_bounds_deg,
)
from railgate.odometer.plant import Sensor, constant
from railgate.odometer.simulate import simulate
from railgate.odometer.spec import Assumptions, Config
from sheets.markdown import between, small, table

__all__ = ["estimators", "periods", "phases"]

FREQUENCIES_KHZ = (Fraction(1, 10), *map(Fraction, (1, 2, 4, 6)))
"""Those of the source's table 1."""
SPEEDS_KMH = (1, 5, 20, 80, 200)
SECONDS = 4.0
EXACT = Assumptions(crystal_ppm=0)
"""The tick alone."""


def phases(megahertz: str) -> str:
    """The source's table 1 with this clock: where each measured T, Δt and φ lies at 90°."""
    config = _clocked(megahertz)
    digits = len(megahertz) + 1  # the source's three at 16 MHz, one more a decade
    rows = []
    for kilohertz in FREQUENCIES_KHZ:
        period = 1 / (1000 * kilohertz)
        times = (interval_bounds_s(seconds, config) for seconds in (period, period / 4))
        told = [between(*(f"{float(end) * 1e6:.4f}" for end in ends)) for ends in times]
        low, high = phase_bounds_deg(1000 * kilohertz, config)
        rows.append(
            (
                f"{float(kilohertz):g}",
                *told,
                between(*(f"{float(end):.{digits}f}" for end in (low, high))),
            )
        )
    return table(("frequency, kHz", "T, µs", "Δt, µs", "φ, degrees"), rows)


def periods(megahertz: str) -> str:
    """Where the speed from one period lies with this clock, by the tick alone, at constant true
    speeds."""
    config = _clocked(megahertz)
    rows = []
    for speed in SPEEDS_KMH:
        low, high = period_bounds_kmh(speed, config)
        hertz = config.clock_hz / config.period_ticks(speed)
        says = between(f"{low:.4f}", f"{high:.4f}")
        rows.append((f"{speed}", f"{hertz:.1f}", says, small(high - low)))
    return table(("speed, km/h", "pulses, Hz", "one period says, km/h", "width, km/h"), rows)


def _clocked(megahertz: str) -> Config:
    return Config(clock_hz=int(megahertz) * 1_000_000)


def estimators(_: str) -> str:
    """Runs of the model at constant speeds: how wide each estimator's guaranteed interval is."""
    told = [list(_widths(name)) for name in ESTIMATORS]
    rows = [(f"{speed}", *(small(of[n]) for of in told)) for n, speed in enumerate(SPEEDS_KMH)]
    return table(("speed, km/h", *(f"`{name}`" for name in ESTIMATORS)), rows)


def _widths(estimator: str) -> Iterator[float]:
    """The mean width of the intervals at each speed, of windows with a measurement, km/h."""
    for speed in SPEEDS_KMH:
        run = simulate(
            constant(speed, SECONDS),
            Sensor(),
            Config(sensors=1),
            estimator=estimator,
            assumptions=EXACT,
        )
        if run.truth_outside:
            raise ValueError(f"the truth must lie inside every interval, not outside {estimator}'s")
        widths = [
            w.speed_high_kmh - w.speed_low_kmh
            for w in run.windows[2:]
            if w.speed_kmh is not None and w.speed_high_kmh is not None
        ]
        yield sum(widths) / len(widths)
