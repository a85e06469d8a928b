"""The snapshots of the odometer's model: when they are taken, and the waveforms they make."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from railgate.odometer.spec import Field
from railgate.waves import Waveform
from railgate.waves.waveform import Ticks, storage

__all__ = ["Columns", "busy", "gates"]


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


@njit(cache=True, nogil=True)
def changes(ticks: Ticks, table: NDArray[np.int64]) -> tuple[Ticks, NDArray[np.int64], Ticks]:
    """Each column of `table`, whose rows begin at `ticks`, without its repeats.

    Returns the ticks and values of all columns one after the other, and where each ends.
    """
    rows, columns = table.shape
    at, values = np.empty(table.size, np.int64), np.empty(table.size, np.int64)
    ends, n = np.empty(columns, np.int64), 0
    for column in range(columns):
        for row in range(rows):
            value = table[row, column]
            if row == 0 or value != table[row - 1, column]:
                at[n], values[n] = ticks[row], value
                n += 1
        ends[column] = n
    return at, values, ends


class Columns:
    """Makes waveforms of the columns of a table, one for each of `fields`."""

    def __init__(self, fields: tuple[Field, ...]) -> None:
        self._fields = [
            (field.name, field.width, field.signed, storage(field.width, field.signed))
            for field in fields
        ]

    def waves(self, ticks: Ticks, table: NDArray[np.int64], prefix: str) -> dict[str, Waveform]:
        """Name -> waveform. ticks: where the rows begin, shape (n,); table: (n, fields)."""
        at, values, ends = changes(ticks, table)
        made, start = {}, 0
        for (name, width, signed, dtype), end in zip(self._fields, ends.tolist(), strict=True):
            held = values[start:end].astype(dtype)
            made[prefix + name] = Waveform.known(at[start:end], held, width, signed)
            start = end
        return made


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
