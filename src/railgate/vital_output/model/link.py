"""The cross-link's receiver: what comes in, what is taken, the peer's clock (DRV-6, DRV-17)."""

from __future__ import annotations

from typing import Any

from numba import njit

from railgate.vital_output.model.frames import check
from railgate.vital_output.model.messages import read
from railgate.vital_output.model.pins import head, pop
from railgate.vital_output.model.records import FAR
from railgate.vital_output.spec import Cause

__all__ = ["complete_tick", "lose", "next_tick", "peer_ok", "receive", "take"]

LINK_CHECK, LINK_DIGEST = int(Cause.LINK_CHECK), int(Cause.LINK_DIGEST)
LINK_SEQUENCE, LINK_LOST = int(Cause.LINK_SEQUENCE), int(Cause.LINK_LOST)
OSCILLATOR = int(Cause.OSCILLATOR)

STEPS = 3
"""So far at most a message's number may be ahead of the one before."""


@njit(nogil=True)
def peer_ok(r: Any) -> bool:
    return r.linked == 1 and r.drifting == 0


@njit(nogil=True)
def complete_tick(limit: Any, begins: int) -> int:
    """In which the verdict is told on a message that begins in a tick."""
    return begins + (limit.message_bits - 1) * limit.bit_ticks + limit.bit_ticks // 2 + 1


@njit(nogil=True)
def next_tick(limit: Any, c: Any, tick: int) -> int:
    """The next one in which the receiver has to look."""
    due = min(head(c.link), c.arrival)
    if c.receiving:
        due = min(due, complete_tick(limit, c.begins))
        start = c.begins + limit.bit_ticks // 2
        due = min(due, start) if start > tick else due
    return due


@njit(nogil=True)
def sample(limit: Any, c: Any, tick: int) -> None:
    """All samples before this tick see the present level."""
    before = tick - c.begins - limit.bit_ticks // 2
    count = min(-(-before // limit.bit_ticks), limit.message_bits)
    for i in range(c.got, count):
        c.received[i] = c.link.level
    c.got = max(c.got, count)


@njit(nogil=True)
def receive(limit: Any, c: Any, tick: int) -> bool:
    """What comes in; whether in this tick a message is there that may be taken."""
    if tick == c.arrival:
        c.arrival = FAR
        return True
    if c.receiving:
        sample(limit, c, tick)
    fell, there = False, False
    if head(c.link) == tick:
        pop(c.link)
        fell = c.link.level == 0
    if c.receiving and tick == c.begins + limit.bit_ticks // 2 and c.link.level:
        c.causes |= 1 << LINK_CHECK
        c.receiving = 0
    if c.receiving and tick == complete_tick(limit, c.begins):
        c.receiving = 0
        right, digest = read(limit, c.received, 1 - c.board, c.incoming, c.values)
        there = right and digest == limit.digest
        if not there:
            c.causes |= 1 << (LINK_DIGEST if right else LINK_CHECK)
    if fell and not c.receiving:
        c.receiving, c.begins, c.got = 1, tick, 0
    return there


@njit(nogil=True)
def take(limit: Any, c: Any, tick: int) -> tuple[bool, bool]:
    """A message is there: whether it is taken, and whether it tells of a boot."""
    was, r, message = c.was, c.now, c.incoming
    step = (message.number - was.number) & 255
    if was.linked and not 1 <= step <= STEPS:
        c.causes |= 1 << LINK_SEQUENCE
        return False, False
    r.number, r.numbered = message.number, 1
    if not was.linked and not (was.numbered and step == 1):
        return False, False
    measure(limit, c, tick, step)
    r.linked, r.taken, r.peer = 1, tick, message
    booted = was.ever_linked == 1 and message.boot != was.peer.boot
    r.ever_linked = 1
    if message.carries:
        known = was.has_seen and not booted and message.frame.sequence == was.seen
        if not known:
            forward(limit, c, tick)
    elif booted:
        r.has_seen = 0
    return True, booted


@njit(nogil=True)
def measure(limit: Any, c: Any, tick: int, step: int) -> None:
    """The peer's clock against the own, when a message is taken (DRV-17)."""
    was, r = c.was, c.now
    off = 0
    if was.linked:
        off = tick - was.offset_zero + 1 - step * limit.link_period_ticks
        r.window = was.window + step
        if abs(off) > limit.drift_limit_ticks:
            c.causes |= 1 << OSCILLATOR
            r.drifting, off, r.window = 1, 0, 0
        elif r.window >= limit.window_messages:
            r.drifting, off, r.window = 0, 0, 0
    else:
        r.window = 0
    r.offset_zero = tick + 1 - off


@njit(nogil=True)
def forward(limit: Any, c: Any, tick: int) -> None:
    """The peer's frame is checked here too."""
    r = c.now
    r.has_seen, r.seen, r.forward = 1, c.incoming.frame.sequence, c.incoming.frame
    r.forward_verdict = check(limit, c.was, tick, r.forward, 1 - c.board, limit.late_ticks)
    r.forward_tick = tick + limit.check_ticks


@njit(nogil=True)
def lose(limit: Any, c: Any, tick: int, taken: bool) -> None:
    """Without a message for too long the link is lost."""
    if c.was.linked and tick == c.was.taken + limit.lost_ticks and not taken:
        c.causes |= 1 << LINK_LOST
        c.now.linked = c.now.numbered = 0
