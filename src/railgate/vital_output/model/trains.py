"""Pulse trains: what a pulse is in which tick, from when to when its output drives (DRV-10)."""

from __future__ import annotations

from typing import Any

from numba import njit

from railgate.vital_output.model.records import FAR

__all__ = ["begin_train", "end_train", "reckon"]


@njit(nogil=True)
def reckon(limit: Any, o: Any, tick: int) -> tuple[int, int]:
    """The pulse in a tick, and the tick, this one or later, after which it is another."""
    last = tick - 1
    if last < o.since:
        return 0, o.since
    if last >= o.until:
        return 0, FAR
    phase = (last - o.since) % limit.period_ticks
    level = phase < limit.half_period_ticks
    toggle = last - phase + (limit.half_period_ticks if level else limit.period_ticks)
    if toggle >= o.until:
        toggle = o.until if level else FAR
    return int(level), toggle


@njit(nogil=True)
def begin_train(o: Any, tick: int) -> None:
    """The output drives from this tick on."""
    o.since, o.until, o.toggle, o.regular = tick, FAR, tick, 0


@njit(nogil=True)
def end_train(limit: Any, o: Any, tick: int) -> None:
    """The output does not drive from this tick on."""
    o.until = tick
    _, o.toggle = reckon(limit, o, tick)
