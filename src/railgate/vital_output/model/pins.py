"""What is behind a synchroniser: filtered levels, and trains whose rises come at the right pace."""

from __future__ import annotations

from typing import Any

from numba import njit

from railgate.vital_output.model.records import FAR, NONE

__all__ = ["alive", "head", "pop", "push", "seat", "turn"]


@njit(nogil=True)
def seat(pin: Any) -> None:
    """All as at start."""
    pin.level, pin.rise, pin.right, pin.count = 0, NONE, 0, 0


@njit(nogil=True)
def push(pin: Any, tick: int, filter_ticks: int) -> None:
    """The pin has changed so that its level would in `tick`, unless it was held too short."""
    last = pin.count - 1
    if last >= 0 and tick - pin.ticks[last] <= filter_ticks:
        pin.count = last
    else:
        pin.ticks[pin.count] = tick
        pin.count += 1


@njit(nogil=True)
def head(pin: Any) -> int:
    """The tick in which the level changes next."""
    return pin.ticks[0] if pin.count else FAR


@njit(nogil=True)
def pop(pin: Any) -> None:
    """The level changes."""
    pin.level ^= 1
    pin.count -= 1
    for i in range(pin.count):
        pin.ticks[i] = pin.ticks[i + 1]


@njit(nogil=True)
def turn(pin: Any, tick: int, low: int, high: int) -> None:
    """The level changes in `tick`; a rise is right if low ≤ since ≤ high."""
    pop(pin)
    if pin.level:
        pin.right = low <= tick - pin.rise <= high
        pin.rise = tick


@njit(nogil=True)
def alive(pin: Any, tick: int, high: int) -> bool:
    """Whether the last rise up to tick - 1 was right, and the next one is not overdue."""
    return pin.right == 1 and tick - pin.rise <= high
