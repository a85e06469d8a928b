"""The source's figures: how far one measured period and one measured phase can lie from the truth.

An edge is stamped at the first tick not before it. Of an interval of T ticks, T real, the stamps
therefore show a whole number above T - 1 and below T + 1 (ODO-3).
Ref: source 000, sections 2.2 and 2.3, table 1. Its T minimum at 1 kHz, 0.99938e-3 s, is a misprint
for 0.999938e-3 s.
"""

from __future__ import annotations

from fractions import Fraction

from railgate.odometer.spec import Config

__all__ = ["interval_bounds_s", "period_bounds_kmh", "phase_bounds_deg"]


def period_bounds_kmh(speed_kmh: float, config: Config) -> tuple[float, float]:
    """Where every one-period speed lies at a constant true speed: (low, high), km/h (ODO-3)."""
    ticks = config.period_ticks(speed_kmh)
    return speed_kmh * ticks / (ticks + 1), speed_kmh * ticks / (ticks - 1)


def interval_bounds_s(seconds: Fraction, config: Config) -> tuple[Fraction, Fraction]:
    """Where every measured interval lies, a period T or a Δt of true length `seconds`: seconds."""
    tick = Fraction(1, config.clock_hz)
    return seconds - tick, seconds + tick


def phase_bounds_deg(
    frequency_hz: Fraction, config: Config, phase_deg: Fraction = Fraction(90)
) -> tuple[Fraction, Fraction]:
    """Where every measured φ lies at a constant true frequency and phase, degrees (ODO-4)."""
    ticks = config.clock_hz / Fraction(frequency_hz)
    delta = phase_deg / 360 * ticks
    return 360 * (delta - 1) / (ticks + 1), 360 * (delta + 1) / (ticks - 1)
