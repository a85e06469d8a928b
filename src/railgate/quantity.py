"""Quantities with a unit, as people write them, to exact SI values."""

from __future__ import annotations

import re
from fractions import Fraction

__all__ = ["frequency_hz", "length_m", "span_s", "time_s"]

_UNITS = {
    "Hz": {"Hz": 0, "kHz": 3, "MHz": 6, "GHz": 9},
    "s": {"s": 0, "ms": -3, "us": -6, "µs": -6, "μs": -6, "ns": -9},
    "m": {"m": 0, "cm": -2, "mm": -3, "um": -6, "µm": -6},
}


def _parse(text: str, unit: str) -> Fraction:
    units = _UNITS[unit]
    found = re.fullmatch(r"\s*(-?\d+(?:\.\d*)?|-?\.\d+)\s*([a-zA-Zµμ]*)\s*", text)
    if not found or (found[2] or unit) not in units:
        raise ValueError(f"a number with {', '.join(units)} is needed, not {text!r}")
    return Fraction(found[1]) * Fraction(10) ** units[found[2] or unit]


def frequency_hz(text: str) -> Fraction:
    """`16MHz` -> 16000000. Raises ValueError."""
    return _parse(text, "Hz")


def time_s(text: str) -> Fraction:
    """`20ms` -> 1/50. Raises ValueError."""
    return _parse(text, "s")


def length_m(text: str) -> Fraction:
    """`650mm` -> 13/20. Raises ValueError."""
    return _parse(text, "m")


def span_s(text: str) -> tuple[Fraction, Fraction]:
    """`0.5s..600ms` -> (1/2, 3/5). Raises ValueError."""
    first, dots, last = text.partition("..")
    if not dots:
        raise ValueError(f"a span T0..T1 is needed, not {text!r}")
    start, end = time_s(first), time_s(last)
    if not start < end:
        raise ValueError(f"a span must end after it begins, not {text!r}")
    return start, end
