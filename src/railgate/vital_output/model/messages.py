"""Messages of the cross-link: their fields, their bits, and how they go out (DRV-6)."""

from __future__ import annotations

from typing import Any

from numba import njit
from numpy.typing import NDArray

from railgate.vital_output.model.records import SENT
from railgate.vital_output.spec import Config, State

__all__ = ["FIRST_MESSAGE", "LATCH", "begins_after", "latch", "read", "resume", "send"]

PRE_DRIVE, DRIVE = int(State.PRE_DRIVE), int(State.DRIVE)
HANDSHAKE_ALARM, FEEDBACK_ALARM = int(State.HANDSHAKE_ALARM), int(State.FEEDBACK_ALARM)

FIRST_MESSAGE = 8
"""The tick in which the first one begins."""
LATCH = 2
"""So many ticks before it begins a message is made."""

FIELDS = tuple(field.name for field in Config().layout.message)
NUMBER, BOOT, DIGEST, TEST = (FIELDS.index(n) for n in ("number", "boot", "digest", "test"))
CODES, CARRIES, PASSED = (FIELDS.index(name) for name in ("codes", "carries", "passed"))
SEQUENCE, IMAGE, ACKNOWLEDGE = (FIELDS.index(n) for n in ("sequence", "image", "acknowledge"))
FRAME_CRC, CRC = FIELDS.index("frame_crc"), FIELDS.index("crc")
CRC_BITS = 32


@njit(nogil=True)
def begins_after(limit: Any, c: Any, s: Any, number: int) -> int:
    """The tick after which a message begins at a sender's end."""
    return c.origin + FIRST_MESSAGE - 1 + s.delay + number * limit.link_period_ticks


@njit(nogil=True)
def latch(limit: Any, c: Any) -> None:
    """The next message is made of what the registers hold."""
    r, message = c.now, c.sent[c.sends % SENT]
    message.number, message.boot, message.test = c.sends & 255, c.boot, r.test_phase
    message.carries, message.passed, message.frame = r.carries, r.passed, r.own
    message.low = message.high = 0
    for i in range(limit.outputs):
        state = c.outputs[i].state
        alarm = state in (HANDSHAKE_ALARM, FEEDBACK_ALARM)
        message.low |= (1 << i) if alarm or state == PRE_DRIVE else 0
        message.high |= (1 << i) if alarm or state == DRIVE else 0
    c.sends += 1
    c.latch += limit.link_period_ticks


@njit(nogil=True)
def crc(limit: Any, bits: NDArray[Any], board: int) -> int:
    """Over all fields of a message of this board but the CRC."""
    register = limit.boards[board]
    for i in range(1, limit.message_bits - CRC_BITS):
        out = register >> 31 & 1
        register = register << 1 & (1 << 32) - 1
        register ^= limit.link_polynomial if out != bits[i] else 0
    return register


@njit(nogil=True)
def draw(limit: Any, message: Any, board: int, bits: NDArray[Any], values: NDArray[Any]) -> None:
    """The bits of a message of this board, its start bit, and behind all of them the idle line.

    values: of its fields, as they are drawn.
    """
    frame, at = message.frame, 1
    values[NUMBER], values[BOOT], values[TEST] = message.number, message.boot, message.test
    values[DIGEST], values[CARRIES], values[PASSED] = limit.digest, message.carries, message.passed
    values[SEQUENCE], values[FRAME_CRC] = frame.sequence, frame.crc
    values[IMAGE], values[ACKNOWLEDGE] = frame.image, frame.acknowledge
    bits[0] = 0
    for i in range(len(FIELDS)):
        if i == CODES:
            for output in range(limit.outputs - 1, -1, -1):
                bits[at] = message.high >> output & 1
                bits[at + 1] = message.low >> output & 1
                at += 2
            continue
        value = crc(limit, bits, board) if i == CRC else values[i]
        for place in range(limit.widths[i] - 1, -1, -1):
            bits[at] = value >> place & 1
            at += 1
    bits[at] = 1


@njit(nogil=True)
def read(
    limit: Any, bits: NDArray[Any], board: int, message: Any, values: NDArray[Any]
) -> tuple[bool, int]:
    """The fields of a message; whether its CRC is right for this board, and its digest."""
    frame, at = message.frame, 1
    message.low = message.high = 0
    for i in range(len(FIELDS)):
        values[i] = 0
        if i == CODES:
            for _ in range(limit.outputs):
                message.high = message.high << 1 | bits[at]
                message.low = message.low << 1 | bits[at + 1]
                at += 2
            continue
        for _ in range(limit.widths[i]):
            values[i] = values[i] << 1 | bits[at]
            at += 1
    message.number, message.boot, message.test = values[NUMBER], values[BOOT], values[TEST]
    message.carries, message.passed = values[CARRIES], values[PASSED]
    frame.sequence, frame.crc = values[SEQUENCE], values[FRAME_CRC]
    frame.image, frame.acknowledge = values[IMAGE], values[ACKNOWLEDGE]
    return values[CRC] == crc(limit, bits, board), values[DIGEST]


@njit(nogil=True)
def send(limit: Any, c: Any, s: Any) -> None:
    """After this tick a bit of a sender's begins, or the quiet behind them."""
    if s.bit == 0:
        draw(limit, c.sent[s.number % SENT], c.board, s.bits, c.values)
    last = limit.message_bits
    s.level = s.bits[s.bit]
    s.bit += 1
    while s.bit <= last and s.bits[s.bit] == s.level:
        s.bit += 1
    if s.bit > last:
        s.bit = 0
        s.number += 1
    s.next = begins_after(limit, c, s, s.number) + s.bit * limit.bit_ticks


@njit(nogil=True)
def resume(limit: Any, c: Any, s: Any, tick: int) -> None:
    """A sender is as if it had sent all that is due before this tick."""
    since = tick - 1 - begins_after(limit, c, s, 0)
    s.number, s.bit, s.level = max(0, since // limit.link_period_ticks), 0, 1
    s.next = begins_after(limit, c, s, s.number)
    while s.next < tick:
        send(limit, c, s)
