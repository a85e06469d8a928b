"""Vote, stored image, its life, errors and start (DRV-5, DRV-6, DRV-7, DRV-15)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from railgate.vital_output.model.frames import ahead, count
from railgate.vital_output.model.link import peer_ok
from railgate.vital_output.model.records import COUNTERS, NONE
from railgate.vital_output.spec import Cause

__all__ = ["keep", "store", "vote"]

SKEW, MISMATCH = int(Cause.SKEW), int(Cause.MISMATCH)
LIFE_OUT, LATCHED = int(Cause.LIFE_OUT), int(Cause.LATCHED)
PASSED, STORED = np.int64(COUNTERS.index("passed")), np.int64(COUNTERS.index("stored"))


@njit(nogil=True)
def vote(limit: Any, c: Any, tick: int, accepted: bool, peer_accepted: bool) -> None:
    was, r = c.was, c.now
    own, forwarded = was.own, was.forwarded
    if was.own_there and was.forwarded_there:
        if (
            own.index == forwarded.index
            and own.sequence == forwarded.sequence
            and own.image == forwarded.image
            and own.acknowledge == forwarded.acknowledge
        ):
            r.passed = r.open = 1
            count(c, PASSED)
        else:
            c.causes |= 1 << MISMATCH
        r.own_there, r.forwarded_there, r.expires = 0, 0, NONE
    elif was.expires == tick:
        if was.own_there or was.forwarded_there:
            c.causes |= 1 << SKEW
        r.own_there, r.forwarded_there, r.expires = 0, 0, NONE
    if accepted:
        r.own_there, r.passed, r.open = 1, 0, 0
    if peer_accepted:
        r.forwarded, r.forwarded_there = was.forward, 1
    if (accepted or peer_accepted) and r.expires == NONE:
        r.expires = tick + limit.tau0_ticks


@njit(nogil=True)
def store(limit: Any, c: Any) -> tuple[bool, int]:
    """Whether the own frame is stored, as both have passed it; the outputs that it acknowledges."""
    was, r = c.was, c.now
    if not (
        was.open
        and peer_ok(was)
        and was.peer.passed
        and was.peer.carries
        and was.peer.frame.sequence == was.own.sequence
    ):
        return False, 0
    count(c, STORED)
    r.image, r.acknowledge = was.own.image, was.own.acknowledge
    r.stored_index = was.own.index
    r.life, r.open = limit.life_cycles, 0
    rises = was.own.acknowledge & ~was.acknowledge
    if rises:
        r.latched = r.first_cause = r.first_output = 0
    return True, rises


@njit(nogil=True)
def decide(c: Any, stored: bool, accepted: bool) -> None:
    """The cycle before is decided."""
    was, r = c.was, c.now
    decided = was.index - 1
    if was.life and not stored and ahead(was.stored_index, decided) < 0:
        r.life = was.life - 1
        if r.life == 0:
            c.causes |= 1 << LIFE_OUT
            r.image = 0
            if not accepted:
                r.referenced = 0
    if ahead(was.own.index, decided) <= 0:
        r.open = 0


@njit(nogil=True)
def keep(
    limit: Any, c: Any, tick: int, accepted: bool, peer_accepted: bool, rejected: bool, booted: bool
) -> int:
    """What drives, and for how long; returns the outputs that are acknowledged."""
    was, r = c.was, c.now
    stored, acknowledged = store(limit, c)
    decision = tick - was.zero == limit.decision_ticks
    if decision:
        decide(c, stored, accepted)
    if rejected and limit.error_interval_cycles:
        if was.errors:
            c.causes |= 0 if r.latched else 1 << LATCHED
            r.latched = 1
        r.errors = limit.error_interval_cycles
    elif decision and was.errors:
        r.errors = was.errors - 1
    if r.latched:
        r.image = 0
    if limit.zero_at_once and accepted:
        r.image &= r.own.image
    if limit.zero_at_once and peer_accepted:
        r.image &= r.forwarded.image
    if booted:
        r.blocked = limit.all_outputs
    elif was.life:
        r.blocked &= was.image
    return int(acknowledged)
