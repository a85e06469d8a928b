"""The log of what is asked for: first of all how many rows it has with this one, then rows of time,
signal and value."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from railgate.vital_output.model.records import SIGNALS

__all__ = ["LOG_ROOM", "note_down"]

CONTACTS = np.int64(2 * len(SIGNALS))
"""The contacts' place in the log, behind the signals of both channels."""

LOG_ROOM = 4 * len(SIGNALS)
"""More rows than the log grows by at one time."""


@njit(nogil=True)
def note_down(st: Any, time: int, log: NDArray[Any]) -> None:
    """What has changed at this time goes into the log, if it is asked for."""
    for d in range(2):
        c = st.channels[d]
        if c.news:
            c.news = 0
            for signal in range(len(SIGNALS)):
                if c.shown[signal] != c.logged[signal]:
                    c.logged[signal] = c.shown[signal]
                    if c.wanted[signal]:
                        write(log, time, c.base + signal, c.shown[signal])
    if st.relays.contact != st.logged:
        st.logged = st.relays.contact
        if st.wanted:
            write(log, time, CONTACTS, st.logged)


@njit(nogil=True)
def write(log: NDArray[Any], time: int, place: int, value: int) -> None:
    row = log[0, 0]
    log[row, 0], log[row, 1], log[row, 2] = time, place, value
    log[0, 0] = row + 1
