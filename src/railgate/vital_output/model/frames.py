"""Command frames: byte for byte in, their check, and what is told of them (DRV-1, DRV-2, DRV-5).

A CRC register can be run backwards: from a frame's CRC over all that is sent, it comes out as it
was behind the implicit time, and so tells the only time with which this CRC is right for a board.
That a mask makes the CRC differ is certain where nothing is broken, so COMPARATOR never comes.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from railgate.vital_output.model.records import COUNTERS
from railgate.vital_output.spec import Cause

__all__ = ["GOOD", "ahead", "check", "count", "take_byte", "told", "trusted"]

GOOD = int(Cause.NONE)
FORMAT, TIME, CORRUPTION = int(Cause.FORMAT), int(Cause.TIME), int(Cause.CORRUPTION)
DELAY, MASQUERADE = int(Cause.DELAY), int(Cause.MASQUERADE)
REPETITION, RESEQUENCE = int(Cause.REPETITION), int(Cause.RESEQUENCE)
INSERTION = int(Cause.INSERTION)
ACCEPTED, START = np.int64(COUNTERS.index("accepted")), np.int64(COUNTERS.index("start"))
LOST = COUNTERS.index("lost")

WORD = (1 << 32) - 1
NUMBER_BYTES, NOTHING = np.int64(4), np.int64(0)
FIRST, LAST = 1 << 8, 1 << 9


@njit(nogil=True)
def ahead(number: int, other: int) -> int:
    """By how much a number of 32 bits is ahead of another."""
    return ((number - other + (1 << 31)) & WORD) - (1 << 31)


@njit(nogil=True)
def backwards(limit: Any, register: int, value: int, count: int) -> int:
    """The CRC's register before the `count` lowest bytes of `value`."""
    for i in range(count):
        at = limit.inverse[register & 255]
        byte = value >> 8 * i & 255
        register = (register ^ limit.table[at]) >> 8 | (at ^ byte) << 24
    return register


@njit(nogil=True)
def trusted(limit: Any, was: Any) -> bool:
    return was.consistent == 1 and was.holdover < limit.holdover_cycles


@njit(nogil=True)
def check(limit: Any, was: Any, tick: int, frame: Any, board: int, late_ticks: int) -> int:
    """The verdict on a frame for a board whose check begins in this tick; sets its index."""
    if not trusted(limit, was):
        return TIME
    behind = backwards(limit, frame.crc, frame.acknowledge, limit.image_bytes)
    behind = backwards(limit, behind, frame.image, limit.image_bytes)
    behind = backwards(limit, behind, frame.sequence, NUMBER_BYTES)
    behind = backwards(limit, behind, NOTHING, NUMBER_BYTES)
    phase = tick - was.zero
    frame.index = behind ^ limit.begun[board]
    step = ahead(frame.index, was.index)
    if step == 0 or (step == -1 and phase < late_ticks):
        return GOOD
    if step == 1 and phase >= limit.cycle_ticks - limit.margin_ticks:
        return GOOD
    if -limit.delay_cycles <= step <= 1:
        return DELAY
    other = ahead(behind ^ limit.begun[1 - board], was.index)
    return MASQUERADE if -limit.delay_cycles <= other <= 1 else CORRUPTION


@njit(nogil=True)
def take_byte(limit: Any, c: Any, payload: int, tick: int) -> None:
    """A byte is transferred in this tick."""
    r = c.now
    if payload & FIRST:
        c.twice, c.begun, c.bytes = c.begun, 1, 0
    if c.bytes < limit.frame_bytes:
        c.buffer[c.bytes] = payload & 255
    c.bytes = min(c.bytes + 1, limit.frame_bytes + 1)
    if payload & LAST:
        whole = c.begun and not c.twice and c.bytes == limit.frame_bytes
        r.verdict = FORMAT
        if whole and read(limit, c.buffer, r.checked):
            r.verdict = check(limit, c.was, tick, r.checked, c.board, limit.margin_ticks)
        r.verdict_tick = tick + limit.check_ticks
        c.begun = c.twice = c.bytes = 0


@njit(nogil=True)
def read(limit: Any, buffer: Any, frame: Any) -> bool:
    """The fields of a frame; whether all bits beyond the outputs are 0."""
    size, image = limit.image_bytes, NUMBER_BYTES
    frame.sequence, frame.image = number(buffer, NOTHING, image), number(buffer, image, size)
    frame.acknowledge = number(buffer, image + size, size)
    frame.crc = number(buffer, image + 2 * size, NUMBER_BYTES)
    return (frame.image | frame.acknowledge) & ~limit.all_outputs == 0


@njit(nogil=True)
def number(buffer: Any, first: int, count: int) -> int:
    value = 0
    for i in range(first, first + count):
        value = value << 8 | buffer[i]
    return value


@njit(nogil=True)
def count(c: Any, counter: int) -> None:
    """A counter grows by 1; it takes its width where it is shown."""
    c.counts[counter] += 1
    c.counted = 1


@njit(nogil=True)
def told(limit: Any, c: Any) -> tuple[bool, bool]:
    """The verdict on the CPU's frame is told; whether it is accepted, and whether rejected."""
    was, r = c.was, c.now
    verdict, step = was.verdict, ahead(was.checked.sequence, was.reference)
    if verdict == GOOD:
        accepted = was.referenced == 1 and (
            step == 1 or (was.life > 0 and 1 <= step <= limit.life_cycles)
        )
        if accepted or was.life == 0:
            r.reference, r.referenced = was.checked.sequence, 1
        if accepted:
            r.own, r.carries = was.checked, 1
            count(c, ACCEPTED)
            c.counts[LOST] += step - 1
            return True, False
        if not was.referenced:
            count(c, START)
            return False, False
        verdict = REPETITION if step == 0 else RESEQUENCE if step < 0 else INSERTION
    c.causes |= 1 << verdict
    return False, verdict != TIME
