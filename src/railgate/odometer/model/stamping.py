"""The stamp FIFO of the odometer's model, from edge to edge and from ready to ready (ODO-13)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numba import njit
from numpy.typing import NDArray

from railgate.odometer.spec import STAMP
from railgate.waves.waveform import Ticks

__all__ = ["PAYLOAD_BITS", "Fifo"]

PAYLOAD_BITS = sum(part.width for part in STAMP)
TICKS = (1 << STAMP[0].width) - 1
LEVELS = STAMP[0].width
LOST = 1 << PAYLOAD_BITS - 1
FAR = 1 << 62
"""Later than every tick."""


@njit(cache=True, nogil=True)
def pass_on(
    puts: Ticks,
    words: NDArray[np.int64],
    tail: int,
    depth: int,
    latency: int,
    free: int,
    lost: int,
    ready: Ticks,
    level: int,
    start: int,
    end: int,
) -> tuple[Ticks, NDArray[np.int64], Ticks, int, int, int, int]:
    """Put the edges puts[tail:] into a FIFO that holds puts[:tail], offer them, take them.

    puts, words: ticks and payloads; what is in the FIFO at the end is moved down in place. free:
    the first tick in which the next entry can be offered. lost: entries were dropped. ready: where
    it changes after `start`, level: what it is there. Returns the ticks and words (-1: nothing) of
    what is offered from then on; the ticks of dropped edges; first and last entry in the FIFO,
    free and lost.
    """
    offered, what = np.empty(2 * puts.size, np.int64), np.empty(2 * puts.size, np.int64)
    dropped, drops, n, head, at = np.empty(puts.size, np.int64), 0, 0, 0, 0
    for edge in range(tail, puts.size + 1):
        tick = puts[edge] if edge < puts.size else end
        while head < tail:
            offer = max(puts[head] + latency, free, start)
            while at < ready.size and ready[at] <= offer:
                at += 1
            taken = offer
            if not level ^ (at & 1):
                taken = ready[at] if at < ready.size else FAR
            if taken >= tick:
                break
            offered[n], what[n] = offer, words[head]
            offered[n + 1], what[n + 1] = taken + 1, -1
            n, head, free = n + 2, head + 1, taken + 1
        if edge == puts.size:
            break
        if tail - head == depth:
            dropped[drops] = tick
            drops, lost = drops + 1, LOST
        else:
            puts[tail], words[tail] = tick, words[edge] | lost
            tail, lost = tail + 1, 0
    if head < tail:
        offered[n], what[n] = max(puts[head] + latency, free, start), words[head]
        n += 1
    return offered[:n], what[:n], dropped[:drops], head, tail, free, lost


@dataclass
class Fifo:
    """The FIFO of one sensor: entries put and not yet taken, and whether some were dropped."""

    puts: Ticks = field(default_factory=lambda: np.empty(0, np.int64))
    words: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, np.int64))
    free: int = 0
    lost: int = 0

    def run(
        self,
        edges: tuple[Ticks, NDArray[np.int64]],
        ready: tuple[Ticks, int],
        span: tuple[int, int],
        origin: int,
        depth: int,
        latency: int,
    ) -> tuple[Ticks, NDArray[np.int64], Ticks]:
        """Run the ticks of `span`, start ≤ tick < end, in which are `edges` (ticks, levels).

        ready: where it changes after start, and its level there. Returns the ticks at which the
        offer changes, first of all start, what it is, -1 for none, and the ticks of dropped edges.
        """
        ticks, levels = edges
        puts = np.concatenate([self.puts, ticks])
        words = np.concatenate([self.words, (ticks - origin) & TICKS | levels << LEVELS])
        offered, what, dropped, head, tail, self.free, self.lost = pass_on(
            puts, words, self.puts.size, depth, latency, self.free, self.lost, *ready, *span
        )
        self.puts, self.words = puts[head:tail].copy(), words[head:tail].copy()
        inside = offered < span[1]
        return (
            np.append(span[0], offered[inside]),
            np.append(-1, what[inside]),
            dropped,
        )
