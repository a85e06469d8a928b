"""The inputs of the odometer's model over a span of ticks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from railgate.waves import Waveform
from railgate.waves.waveform import Ticks

__all__ = ["NO_TICKS", "Input", "stretches"]

NO_TICKS: Ticks = np.empty(0, np.int64)
NO_TICKS.flags.writeable = False


@dataclass(frozen=True)
class Input:
    """One input over a span: its level at the start, and the ticks after it at which it changes."""

    level: int
    changes: Ticks

    @classmethod
    def of(cls, wave: Waveform, start: int, end: int) -> Input:
        first, last = wave.ticks.searchsorted([start + 1, end]).tolist()
        changes = wave.ticks[first : max(first, last)]
        changes.flags.writeable = False  # numba compiles anew for each kind of array it is given
        return cls(int(wave.values[first - 1]), changes)

    @property
    def last(self) -> int:
        return self.level ^ (self.changes.size & 1)

    def part(self, start: int, end: int) -> Input:
        first, last = self.changes.searchsorted([start + 1, end]).tolist()
        return Input(self.level ^ (first & 1), self.changes[first : max(first, last)])


def stretches(rst: Input, start: int, until: int) -> Iterator[tuple[int, int | None]]:
    """The end of each stretch without reset, and the tick 0 that follows it, None for the last."""
    edges = [start] if rst.level else []
    edges += rst.changes.tolist()
    now = start
    for high, low in zip(edges[::2], [*edges[1::2], until], strict=False):
        yield high + 1, low
        now = low
    if now < until or start == until:
        yield until, None
