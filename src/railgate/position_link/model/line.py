"""What the line says, cycle by cycle or pulse by pulse, compiled (LNK-3, LNK-4).

A cycle costs its edges and the bits of its answer; the ticks of its samples are computed or
captured alike. Ticks are those of the pins: the delay of the filters cancels out. All kernels
stand in this one file, since numba's cache does not see a change in another.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from railgate.position_link.model.words import Words
from railgate.position_link.spec import Cause
from railgate.waves.waveform import Ticks

__all__ = ["FAR", "FOUND", "LINE", "NONE", "complete", "cycles", "pulses"]

FAR = 1 << 62
"""Later than every tick."""
NONE = -FAR
"""No tick."""

TIMEOUT, EARLY, SHORT = int(Cause.TIMEOUT), int(Cause.EARLY), int(Cause.SHORT)
LONG, STUCK, UNREQUESTED = int(Cause.LONG), int(Cause.STUCK), int(Cause.UNREQUESTED)
UNSTABLE = int(Cause.UNSTABLE)

LINE = np.dtype(
    [
        (name, np.int64)
        for name in ("word_bits", "guard_ticks", "at_u", "level_u", "at_d", "level_d")
    ]
)
"""How the line is read, and how far UEF and DATA are: index of the next edge, level before it."""

FOUND = np.dtype([(name, np.int64) for name in ("rise", "fall", "causes")])
"""One cycle or pulse: ticks in which UEF rose and fell for its answer (NONE: no answer, FAR: it
has not fallen yet), and the causes in it. An answer neither SHORT nor LONG has a complete word."""


def complete(found: Any) -> NDArray[np.bool_]:
    """Whether there was an answer with a complete word, of each of `found`."""
    whole: NDArray[np.bool_] = (found["rise"] != NONE) & (found["causes"] & (SHORT | LONG) == 0)
    return whole


@njit(cache=True, nogil=True)
def unstable(line: Any, d: Ticks, sample: int) -> bool:
    """Whether an edge of DATA is too near to a sample, before which d[at_d] is the next one."""
    guard = line.guard_ticks
    if line.at_d > 0 and d[line.at_d - 1] > sample - guard:
        return True
    return bool(line.at_d < d.size and d[line.at_d] <= sample + guard)


@njit(cache=True, nogil=True)
def answer(
    line: Any, samples: Ticks, base: int, d: Ticks, rise: int, fall: int, word: NDArray[np.uint64]
) -> int:
    """Read one answer into `word`, sampled in ticks base + samples; returns its causes."""
    first, bits, part, causes = np.searchsorted(samples, rise - base), line.word_bits, 0, 0
    for n in range(bits + 1):
        sample = base + samples[first + n] if first + n < samples.size else FAR
        if sample >= fall:
            return causes if n == bits else causes | SHORT
        if n == bits:
            break
        while line.at_d < d.size and d[line.at_d] <= sample:
            line.level_d ^= 1
            line.at_d += 1
        causes |= UNSTABLE if unstable(line, d, sample) else 0
        part = part << 1 | line.level_d
        left = bits - 1 - n
        if left & 63 == 0:
            word[left >> 6] = np.uint64(part)
            part = 0
    return causes | LONG


@njit(cache=True, nogil=True)
def cycle(
    line: Any,
    samples: Ticks,
    base: int,
    span: NDArray[np.int64],
    u: Ticks,
    d: Ticks,
    word: NDArray[np.uint64],
    row: Any,
) -> None:
    """Read one cycle, and what came before it since the last."""
    start, opens, closes, last = span
    row.rise, row.fall, row.causes = NONE, NONE, 0
    while line.at_u < u.size and u[line.at_u] < start:
        line.level_u ^= 1
        line.at_u += 1
        row.causes |= UNREQUESTED if line.level_u else 0
    seen = line.level_u == 1 and not (line.at_u < u.size and u[line.at_u] == start)
    row.causes |= STUCK if seen else 0
    while line.at_u < u.size and u[line.at_u] <= last:
        tick = u[line.at_u]
        line.level_u ^= 1
        line.at_u += 1
        if not line.level_u:
            continue
        seen |= tick < closes
        if tick < opens:
            row.causes |= EARLY
        elif tick < closes and row.rise == NONE:
            row.rise, row.fall = tick, u[line.at_u] if line.at_u < u.size else FAR
            row.causes |= answer(line, samples, base, d, tick, row.fall, word)
        else:
            row.causes |= UNREQUESTED
    row.causes |= 0 if seen else TIMEOUT
    while line.at_d < d.size and d[line.at_d] <= last:
        line.level_d ^= 1
        line.at_d += 1


@njit(cache=True, nogil=True)
def cycles(
    line_of: Any,
    samples: Ticks,
    bases: Ticks,
    spans: NDArray[np.int64],
    u: Ticks,
    d: Ticks,
    words: Words,
    found: Any,
) -> None:
    """Read cycles.

    line_of: shape (1,), LINE. samples: ascending, of each cycle after its base, shape (n,). spans:
    of each cycle the tick in which it starts, those in which its window opens and closes, and the
    last one that counts, shape (n, 4). u, d: the ticks in which UEF and DATA change. Complete words
    go into `words`, what was found into `found`, FOUND, shape (n,).
    """
    for i in range(bases.size):
        cycle(line_of[0], samples, bases[i], spans[i], u, d, words[i], found[i])


@njit(cache=True, nogil=True)
def pulses(line_of: Any, samples: Ticks, u: Ticks, d: Ticks, words: Words, found: Any) -> None:
    """Read every pulse of UEF as an answer; u begins with a rise. Arguments as of `cycles`."""
    for i in range(found.size):
        row = found[i]
        row.rise, row.fall = u[2 * i], u[2 * i + 1] if 2 * i + 1 < u.size else FAR
        row.causes = answer(line_of[0], samples, 0, d, row.rise, row.fall, words[i])
