"""The relays in the loop: dynamic stages, coil, contact (DRV-13)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from railgate.vital_output.model.pins import alive, head, seat, turn
from railgate.vital_output.model.records import FAR, INPUTS
from railgate.vital_output.model.wires import RELAYS, ROGUES, feed, label, repin

__all__ = ["begin_relays", "halt_relays", "tick_of_relays"]

ALL_OPEN = np.int64(0)
WELDED, BROKEN = INPUTS.index("welded"), INPUTS.index("broken")


@njit(nogil=True)
def begin_relays(st: Any, limit: Any, tick: int) -> None:
    """This is a new tick 0: all as at start."""
    r = st.relays
    r.origin = tick
    for d in range(2):
        r.fed[d] = 0
        for i in range(limit.outputs):
            seat(r.stages[d, i])
        feed(st, limit, d, tick)
    for i in range(limit.outputs):
        r.apart[i] = FAR


@njit(nogil=True)
def halt_relays(st: Any, limit: Any, time: int) -> None:
    """Reset: from the next tick on the contacts are open."""
    st.relays.due = FAR
    if st.relays.contact:
        switch(st, limit, ALL_OPEN, time)


@njit(nogil=True)
def switch(st: Any, limit: Any, contact: int, time: int) -> None:
    """From this time on the contacts are so, and both channels may see it."""
    st.relays.contact = contact
    for d in range(2):
        c, domain = st.channels[d], st.domains[d]
        c.contact = contact
        repin(limit, c, domain, label(st, d, time))


@njit(nogil=True)
def tick_of_relays(st: Any, limit: Any, tick: int, time: int) -> None:
    """All that happens in one tick, which ends at this time."""
    r, held = st.relays, st.domains[RELAYS].held
    due, changed, moved = FAR, 0, False
    for i in range(limit.outputs):
        coil = held[BROKEN] >> i & 1 == 0
        for d in range(2):
            stage, still = r.stages[d, i], r.still[d] >> i & 1 == 1
            coil &= still or alive(stage, tick, r.high)
            if head(stage) == tick:
                turn(stage, tick, r.low, r.high)
                moved = True
            if not still:
                due = min(due, head(stage))
                overdue = stage.rise + r.high + 1
                due = min(due, overdue) if overdue > tick else due
        closed = r.contact >> i & 1 == 1
        if coil == closed:
            r.apart[i] = FAR
            continue
        r.apart[i] = min(r.apart[i], tick)
        moves = r.apart[i] + (r.release if closed else r.pick_up) - 1
        if moves > tick:
            due = min(due, moves)
        elif not (closed and held[WELDED] >> i & 1):
            changed |= 1 << i
            r.apart[i] = FAR
    if changed:
        switch(st, limit, r.contact ^ changed, time)
    if held[ROGUES] | held[ROGUES + 1]:
        phase, half = (tick - r.origin) % r.period, r.period // 2
        due = min(due, tick - phase + (half if phase < half else r.period))
    r.due = tick + 1 if moved or changed else due
