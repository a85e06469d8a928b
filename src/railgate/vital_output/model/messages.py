"""Messages of the cross-link: their fields, their bits, and the line that they go out on (DRV-6)."""

from __future__ import annotations

from typing import Any

from numba import njit
from numpy.typing import NDArray

from railgate.vital_output.spec import State

__all__ = ["FIRST_MESSAGE", "LATCH", "latch", "read", "resume", "send"]

PRE_DRIVE, DRIVE = int(State.PRE_DRIVE), int(State.DRIVE)
HANDSHAKE_ALARM, FEEDBACK_ALARM = int(State.HANDSHAKE_ALARM), int(State.FEEDBACK_ALARM)

FIRST_MESSAGE = 8
"""The tick in which the first one begins."""
LATCH = 2
"""So many ticks before it begins a message is made."""
CRC_BITS = 32


@njit(nogil=True)
def latch(limit: Any, c: Any, message: Any) -> None:
    """The next message is made of what the registers hold."""
    r = c.now
    message.number, message.boot, message.test = c.sends & 255, c.boot, r.test_phase
    message.carries, message.passed, message.frame = r.carries, r.passed, r.own
    message.low = message.high = 0
    for i in range(limit.outputs):
        state = c.outputs[i].state
        alarm = state == HANDSHAKE_ALARM or state == FEEDBACK_ALARM
        message.low |= (1 << i) if alarm or state == PRE_DRIVE else 0
        message.high |= (1 << i) if alarm or state == DRIVE else 0
    c.sends += 1
    c.latch += limit.link_period_ticks


@njit(nogil=True)
def put(bits: NDArray[Any], at: int, value: int, width: int) -> int:
    for i in range(width):
        bits[at + i] = value >> width - 1 - i & 1
    return at + width


@njit(nogil=True)
def take(bits: NDArray[Any], at: int, width: int) -> int:
    value = 0
    for i in range(at, at + width):
        value = value << 1 | bits[i]
    return value


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
def draw(limit: Any, message: Any, board: int, bits: NDArray[Any]) -> None:
    """The bits of a message of this board, its start bit, and behind all of them the idle line."""
    at = put(bits, 0, 0, 1)
    at = put(bits, at, message.number, 8)
    at = put(bits, at, message.boot, 16)
    at = put(bits, at, limit.digest, 32)
    at = put(bits, at, message.test, 2)
    for i in range(limit.outputs - 1, -1, -1):
        at = put(bits, put(bits, at, message.high >> i, 1), message.low >> i, 1)
    at = put(bits, put(bits, at, message.carries, 1), message.passed, 1)
    at = put(bits, at, message.frame.sequence, 32)
    at = put(bits, at, message.frame.image, limit.outputs)
    at = put(bits, at, message.frame.acknowledge, limit.outputs)
    at = put(bits, at, message.frame.crc, 32)
    at = put(bits, at, crc(limit, bits, board), CRC_BITS)
    bits[at] = 1


@njit(nogil=True)
def read(limit: Any, bits: NDArray[Any], board: int, message: Any) -> tuple[bool, int]:
    """The fields of a message; whether its CRC is right for this board, and its digest."""
    message.number, message.boot = take(bits, 1, 8), take(bits, 9, 16)
    digest, message.test = take(bits, 25, 32), take(bits, 57, 2)
    at = 59
    message.low = message.high = 0
    for _ in range(limit.outputs):
        message.high = message.high << 1 | bits[at]
        message.low = message.low << 1 | bits[at + 1]
        at += 2
    message.carries, message.passed = bits[at], bits[at + 1]
    frame, at, outputs = message.frame, at + 2, limit.outputs
    frame.sequence, frame.image = take(bits, at, 32), take(bits, at + 32, outputs)
    frame.acknowledge = take(bits, at + 32 + outputs, outputs)
    at += 32 + 2 * outputs
    frame.crc = take(bits, at, 32)
    return take(bits, at + 32, CRC_BITS) == crc(limit, bits, board), digest


@njit(nogil=True)
def send(limit: Any, c: Any, sent: Any, sender: int, delay_ticks: int) -> int:
    """After this tick a bit begins, or the quiet behind them; returns the level of the line.

    sent: the messages that may still be on their way, each at its number modulo their count.
    """
    s = c.senders[sender]
    if s.bit == 0:
        draw(limit, sent[s.number % sent.size], c.board, s.bits)
    level, last = s.bits[s.bit], limit.message_bits
    s.bit += 1
    while s.bit <= last and s.bits[s.bit] == level:
        s.bit += 1
    if s.bit > last:
        s.bit = 0
        s.number += 1
    begin = c.origin + FIRST_MESSAGE - 1 + s.number * limit.link_period_ticks
    s.next = begin + delay_ticks + s.bit * limit.bit_ticks
    return int(level)


@njit(nogil=True)
def resume(limit: Any, c: Any, sent: Any, sender: int, tick: int) -> int:
    """All that was sent in ticks before `tick`, without a delay; returns the level of the line."""
    s, level = c.senders[sender], 1
    first = c.origin + FIRST_MESSAGE - 1
    s.number, s.bit = max(0, (tick - 1 - first) // limit.link_period_ticks), 0
    s.next = first + s.number * limit.link_period_ticks
    while s.next < tick:
        level = send(limit, c, sent, sender, 0)
    return level
