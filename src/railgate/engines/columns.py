"""The outputs of an event-driven model: waveforms made of the columns of a table."""

from __future__ import annotations

from collections.abc import Collection, Iterable

import numpy as np
from numba import njit
from numpy.typing import NDArray

from railgate.waves import Waveform
from railgate.waves.waveform import Ticks, storage

__all__ = ["Columns"]


@njit(cache=True, nogil=True)
def changes(
    ticks: Ticks, table: NDArray[np.int64], columns: NDArray[np.int64]
) -> tuple[Ticks, NDArray[np.int64], Ticks]:
    """Each of the `columns` of a table whose rows begin at `ticks`, without its repeats.

    Returns the ticks and values of all of them one after the other, and where each ends.
    """
    rows = table.shape[0]
    at, values = np.empty(rows * columns.size, np.int64), np.empty(rows * columns.size, np.int64)
    ends, n = np.empty(columns.size, np.int64), 0
    for i in range(columns.size):
        for row in range(rows):
            value = table[row, columns[i]]
            if row == 0 or value != table[row - 1, columns[i]]:
                at[n], values[n] = ticks[row], value
                n += 1
        ends[i] = n
    return at, values, ends


class Columns:
    """Makes waveforms of the columns of a table; shapes: name, width and sign of each."""

    def __init__(self, shapes: Iterable[tuple[str, int, bool]]) -> None:
        self._shapes = [(*shape, storage(*shape[1:])) for shape in shapes]

    def waves(
        self, ticks: Ticks, table: NDArray[np.int64], names: Collection[str], prefix: str = ""
    ) -> dict[str, Waveform]:
        """Name -> waveform, of the columns whose name behind `prefix` is one of `names`.

        ticks: where the rows begin, shape (n,); table: the bits of each value, (n, columns).
        """
        wanted = [i for i, (name, *_) in enumerate(self._shapes) if prefix + name in names]
        at, values, ends = changes(ticks, table, np.array(wanted, np.int64))
        made, start = {}, 0
        for i, end in zip(wanted, ends.tolist(), strict=True):
            name, width, signed, dtype = self._shapes[i]
            held = values[start:end].astype(dtype)
            made[prefix + name] = Waveform.known(at[start:end], held, width, signed)
            start = end
        return made
