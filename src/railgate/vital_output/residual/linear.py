"""A check as a linear code: an error passes where the syndromes of its bits add up to 0.

Initial value and final xor of a CRC are the same with and without the error, so that they do not
count here.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from railgate.check import Check

__all__ = ["Syndromes", "burst", "eliminate", "syndromes"]

Syndromes = NDArray[np.uint64]
"""Of the bits of a code word, the first sent first: what an error of this bit adds to the check."""
MOST = 64
"""Bits of a syndrome: one more of them in a row are never independent."""


def syndromes(check: Check, count: int) -> Syndromes:
    """Of the `count` bits of a code word, its last `width` ones the check field itself."""
    top = 1 << check.width
    values = [1]
    for _ in range(count - 1):
        value = values[-1] << 1
        values.append(value ^ (top | check.polynomial) if value & top else value)
    return np.array(values[::-1], np.uint64)


def eliminate(vectors: Iterable[int]) -> tuple[list[int], list[int]]:
    """A basis over GF(2) of what the vectors span, and one of their sums that are 0.

    The first has as many members as the rank. A sum is a mask: bit i for vector i.
    """
    pivots: dict[int, tuple[int, int]] = {}
    sums = []
    for i, vector in enumerate(vectors):
        mask = 1 << i
        while vector and (pivot := pivots.get(vector.bit_length())):
            vector, mask = vector ^ pivot[0], mask ^ pivot[1]
        if vector:
            pivots[vector.bit_length()] = vector, mask
        else:
            sums.append(mask)
    return [vector for vector, _ in pivots.values()], sums


def burst(syndromes: Syndromes) -> int:
    """The length up to which every burst is detected, whatever its bits and wherever it lies.

    That is, so many syndromes in a row are linearly independent at every place.
    """
    columns = [int(syndrome) for syndrome in syndromes]
    shortest = len(columns)
    for start in range(len(columns)):
        _, sums = eliminate(columns[start : start + MOST + 1])
        if sums:
            shortest = min(shortest, sums[0].bit_length() - 1)
    return shortest
