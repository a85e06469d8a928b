"""The inputs of an event-driven model over a span of ticks: pins, resets, glitch filter."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numba import njit

from railgate.waves import Waveform
from railgate.waves.waveform import Ticks

__all__ = ["NO_TICKS", "Filter", "Input", "filtered", "stretches"]

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

    def after(self, pending: Ticks, level: int, start: int) -> Ticks:
        """The changes yet to be run, where before `start` there were `pending`, up to `level`."""
        jump = [start] if self.level != level else []
        if not pending.size and not jump:
            return self.changes
        changes = np.concatenate([pending, np.array(jump, np.int64), self.changes])
        changes.flags.writeable = False
        return changes


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


@njit(cache=True, nogil=True)
def filtered(pins: Ticks, filter_ticks: int, end: int) -> tuple[Ticks, Ticks, int]:
    """What a filter makes of a pin that changes at `pins` and is known in ticks below `end`.

    Returns the changes that pass, in ticks of the pin (behind the filter 3 + filter_ticks later);
    the ticks in which the rejected glitches are told; how many of `pins` are decided.
    """
    passed, rejected = np.empty(pins.size, np.int64), np.empty(pins.size // 2, np.int64)
    at = n = m = 0
    while at < pins.size:
        last = at + 1 == pins.size
        held = (end if last else pins[at + 1]) - pins[at]
        if held > filter_ticks:
            passed[n] = pins[at]
            n, at = n + 1, at + 1
        elif last:
            break
        else:
            rejected[m] = pins[at + 1] + 2
            m, at = m + 1, at + 2
    return passed[:n], rejected[:m], at


@dataclass
class Filter:
    """A synchroniser and glitch filter from span to span (primitives.FilteredInput's twin).

    level: of the pin, as it was last seen. pending: changes of it that are not decided yet.
    """

    filter_ticks: int
    level: int = 0
    pending: Ticks = field(default_factory=lambda: NO_TICKS)

    def take(self, pin: Input, start: int, end: int) -> tuple[Ticks, Ticks]:
        """The changes that pass and the ticks of rejected glitches, as `filtered` tells them."""
        pins = pin.after(self.pending, self.level, start)
        passed, rejected, decided = filtered(pins, self.filter_ticks, end)
        self.level, self.pending = pin.last, pins[decided:].copy()
        return passed, rejected
