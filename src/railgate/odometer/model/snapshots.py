"""The snapshots of the odometer's model: when they are taken."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from railgate.waves.waveform import Ticks

__all__ = ["busy", "gates"]


@njit(cache=True, nogil=True)
def gates(strobe: Ticks, level: int, start: int, end: int, free: int, latency: int) -> Ticks:
    """The ticks in start ≤ tick < end at which a strobe finds the gate open.

    strobe: where it changes after `start`, level: what it is there. free: first tick not busy.
    """
    room = 1
    for at in range(strobe.size + 1):
        since = start if at == 0 else strobe[at - 1]
        until = end if at == strobe.size else strobe[at]
        room += (until - since) // latency + 1 if level ^ (at & 1) else 0
    found, n = np.empty(room, np.int64), 0
    for at in range(strobe.size + 1):
        tick = max(start if at == 0 else strobe[at - 1], free)
        until = end if at == strobe.size else strobe[at]
        while level ^ (at & 1) and tick < until:
            found[n] = tick
            n += 1
            tick = free = tick + latency
    return found[:n]


def busy(shown: Ticks, start: int, end: int, latency: int) -> tuple[Ticks, NDArray[np.bool_]]:
    """Where busy changes in start ≤ tick < end, and to what; first of all its value at `start`.

    shown: the ticks at which a snapshot begins to be shown, of all that are not shown at `start`.
    """
    ticks = np.repeat(shown, 2)
    ticks[::2] -= latency - 1
    high = np.arange(ticks.size) % 2 == 0
    before, after = np.searchsorted(ticks, [start, end], side="left")
    first = bool(before % 2)
    return np.append(start, ticks[before:after]), np.append(first, high[before:after])
