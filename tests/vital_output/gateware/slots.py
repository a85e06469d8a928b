"""Frames in the vote's slots, as inputs of the bench."""

from __future__ import annotations

from collections.abc import Mapping

from vital_output.gateware.bench import Changes
from vital_output.small import SMALL

__all__ = ["FIELDS", "slots"]

FIELDS = {"index": 32, "sequence": 32, "image": SMALL.outputs, "acknowledge": SMALL.outputs}
"""The fields of a slot of a channel with two outputs, the least significant one first."""


def slots(name: str, frames: Mapping[int, Mapping[str, int]]) -> dict[str, Changes]:
    """What the port `name`, which is in two parts, holds from each of these ticks on."""
    numbers = {tick: _packed(frame) for tick, frame in frames.items()}
    return {
        f"{name}.0": {tick: number & (1 << 64) - 1 for tick, number in numbers.items()},
        f"{name}.1": {tick: number >> 64 for tick, number in numbers.items()},
    }


def _packed(frame: Mapping[str, int]) -> int:
    number = place = 0
    for name, width in FIELDS.items():
        number |= frame[name] << place
        place += width
    return number
