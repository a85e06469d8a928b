"""One figure of a bench."""

from __future__ import annotations

from typing import Any

__all__ = ["Row", "row"]

Row = dict[str, Any]


def row(
    name: str,
    value: float,
    unit: str = "",
    *,
    least: float | None = None,
    most: float | None = None,
) -> Row:
    """A figure, and its goal where it has one: `value` at least, or at most that.

    Keys: name, value, unit, goal, sense (≥, ≤ or None), met (None where there is no goal).
    """
    goal, sense, met = None, None, None
    if least is not None:
        goal, sense, met = least, "≥", bool(value >= least)
    if most is not None:
        goal, sense, met = most, "≤", bool(value <= most)
    return {"name": name, "value": value, "unit": unit, "goal": goal, "sense": sense, "met": met}
