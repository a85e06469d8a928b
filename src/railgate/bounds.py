"""The check that configurations make of their numbers."""

from __future__ import annotations

from fractions import Fraction

__all__ = ["require"]

Number = float | Fraction


def require(owner: object, *bounds: tuple[str, Number, Number]) -> None:
    """Raises ValueError unless low ≤ attribute ≤ high for each (name, low, high)."""
    for name, low, high in bounds:
        value = getattr(owner, name)
        if not low <= value <= high:
            raise ValueError(f"{name} must be between {low} and {high}, not {value}")
