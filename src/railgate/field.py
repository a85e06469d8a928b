"""A field of a record that gateware makes and the host reads."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Field"]


@dataclass(frozen=True)
class Field:
    """One field: its name, width in bits, meaning, unit, sign, and what it holds at start."""

    name: str
    width: int
    meaning: str
    unit: str = ""
    signed: bool = False
    start: int = 0
