"""Clock edges in ticks of the common time base, exact, and back."""

from __future__ import annotations

from fractions import Fraction
from math import lcm
from typing import Any

import numpy as np
from numba import njit

from railgate.engines import Clock
from railgate.engines.signals import LAST_TICK
from railgate.waves.waveform import Ticks

__all__ = ["CLOCK", "clock_of", "edge", "sampled", "ticks_of"]

CLOCK = np.dtype(
    [
        (name, np.int64)
        for name in ("whole", "rest", "phase_whole", "phase_rest", "unit", "digit_bits", "top")
    ]
    + [("rate", np.float64), ("ahead", np.float64)]
)
"""Period and phase in ticks of the time base, each a whole number and a rest in 1 / unit. An edge's
number is multiplied with the period's rest digit by digit, so that no product leaves 64 bits."""


def clock_of(clock: Clock, base: Fraction) -> Any:
    """A clock in a time base of `base` s. Shape (1,), CLOCK. Raises ValueError where the period is
    so odd a fraction of it that 64 bits do not hold it."""
    period = clock.period / base
    phase = clock.phase * period
    unit = lcm(period.denominator, phase.denominator)
    edge_bits = (LAST_TICK // period + 2).__floor__().bit_length()
    digit_bits = min(62 - unit.bit_length(), edge_bits)
    if digit_bits < 4:
        raise ValueError(
            f"a clock's period and phase must be whole numbers of 1/d tick with a d below 2⁵⁸, "
            f"not of 1/{unit} tick"
        )
    (whole, rest), (phase_whole, phase_rest) = (
        divmod(int(part * unit), unit) for part in (period, phase)
    )
    top = digit_bits * ((edge_bits - 1) // digit_bits)
    numbers = (whole, rest, phase_whole, phase_rest, unit, digit_bits, top)
    return np.array([(*numbers, float(1 / period), 1 + float(clock.phase))], CLOCK)


@njit(nogil=True)
def edge(clock: Any, n: int) -> int:
    """The tick of edge n ≥ -1: the first one not before (n + 1 + phase) · period."""
    count, quotient, remainder, at = n + 1, 0, 0, clock.top
    digit = (1 << clock.digit_bits) - 1
    while at >= 0:
        product = (remainder << clock.digit_bits) + (count >> at & digit) * clock.rest
        part = product // clock.unit
        quotient = (quotient << clock.digit_bits) + part
        remainder = product - part * clock.unit
        at -= clock.digit_bits
    rest = remainder + clock.phase_rest
    return count * clock.whole + clock.phase_whole + quotient + (rest > 0) + (rest > clock.unit)


@njit(nogil=True)
def sampled(clock: Any, time: int) -> int:
    """The number of the first edge after a tick: what has changed in it is sampled there."""
    n = max(int(time * clock.rate - clock.ahead), 0)
    at = edge(clock, n)
    while at <= time:
        n += 1
        at = edge(clock, n)
    while n > 0 and at - time > clock.whole and edge(clock, n - 1) > time:
        n -= 1
        at = edge(clock, n)
    return n


@njit(cache=True, nogil=True)
def ticks_of(clock_of: Any, times: Ticks) -> Ticks:
    """`sampled` of each of these ticks. clock_of: shape (1,), CLOCK."""
    found = np.empty(times.size, np.int64)
    for i in range(times.size):
        found[i] = sampled(clock_of[0], times[i])
    return found
