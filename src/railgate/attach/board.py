"""What is on a board: its blocks, by the identity that each begins with."""

from __future__ import annotations

from collections.abc import Iterator

from railgate.attach.gauges import GAUGES, Gauge
from railgate.registers import WORD_BYTES
from railgate.registers.host import AccessError, Bus
from railgate.unit.config import Unit

__all__ = ["find"]

LETTERS = 3
GREATEST = 12
"""No block is greater than 2¹² bytes."""


def find(bus: Bus, unit: Unit) -> list[Gauge]:
    """A gauge of each function on the bus, which must be configured as the unit's.

    Blocks are looked for where Map.of puts them: the first one at 0, each other one at the first
    multiple of its size behind the one before. Raises BusError; ValueError for what has no identity
    that is known, or another configuration, and where there is nothing.
    """
    found: list[Gauge] = []
    end = 0
    while (base := _next(bus, end)) is not None:
        gauge = _gauge(bus, unit, base)
        gauge.registers.require_same()
        found.append(gauge)
        end = base + gauge.registers.block.size
    if not found:
        raise ValueError("the board must have a function at address 0, and has none")
    return found


def _next(bus: Bus, end: int) -> int | None:
    """The base of the next block, None where there is none."""
    for base in _bases(end):
        try:
            bus.read(base)
        except AccessError:
            continue
        return base
    return None


def _bases(end: int) -> Iterator[int]:
    """Where a block behind `end` can be, one after the other: by its size."""
    sizes = [1 << bits for bits in range(WORD_BYTES.bit_length() - 1, GREATEST + 1)]
    yield from sorted({-(-end // size) * size for size in sizes})


def _gauge(bus: Bus, unit: Unit, base: int) -> Gauge:
    code = bus.read(base)[0] >> 8
    letters = code.to_bytes(LETTERS, "big").decode("ascii", "replace")
    if letters not in GAUGES:
        raise ValueError(
            f"the identity at {base:#x} must be of {', '.join(GAUGES)}, not {code:#08x}"
        )
    return GAUGES[letters](bus, unit, base)
