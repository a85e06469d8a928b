"""Errors of few bits that pass a CRC, counted exactly, for all lengths of the code word at once.

An error that passes is a multiple of the polynomial, and stays one when it is shifted. So only
those are counted whose last bit is the code word's last, by the place of their first bit: one that
spans s bits fits into a code word of n bits in n - s + 1 places. They are found in the middle: the
syndromes of their later bits add up to those of their earlier ones.
"""

from __future__ import annotations

from collections.abc import Callable
from math import comb

import numpy as np
from numpy.typing import NDArray

from railgate.check import Check
from railgate.vital_output.residual.linear import Syndromes, syndromes

__all__ = ["Few", "distances", "few", "passing"]

Few = NDArray[np.int64]
"""How many errors pass, by their bits, from 0 on, and the code word's length, from 0 on."""
PLACE_BITS = 16
"""A key has a sum of syndromes above and a place below."""
PLACE = np.uint64((1 << PLACE_BITS) - 1)


def few(check: Check, most: int, longest: int, told: Callable[[float], None] | None = None) -> Few:
    """Of 0 … `most` bits, in code words of 0 … longest bits. Raises ValueError as `passing`."""
    counts = [np.zeros(longest + 1, np.int64)]
    for bits in range(1, most + 1):
        counts.append(passing(check, bits, longest))
        if told:
            told(bits / most)
    return np.array(counts)


def distances(counts: Few) -> NDArray[np.int64]:
    """The Hamming distance by the code word's length; len(counts) where it is that or more."""
    found = counts > 0
    return np.where(found.any(axis=0), found.argmax(axis=0), len(counts))


def passing(check: Check, bits: int, longest: int) -> NDArray[np.int64]:
    """How many errors of so many bits pass, in code words of 0 … longest bits. Raises ValueError.

    check: a CRC of at most 48 bits whose polynomial is odd.
    """
    if not 1 <= longest < 1 << PLACE_BITS:
        raise ValueError(f"longest must be between 1 and {(1 << PLACE_BITS) - 1}, not {longest}")
    if bits < 2:
        return np.zeros(longest + 1, np.int64)  # no power of x is a multiple
    columns = syndromes(check, longest)[::-1]  # the last bit, whose place is 0, comes first
    late, early = (bits - 1) // 2, bits - 2 - (bits - 1) // 2
    sums, _, ends = _sums(columns, late)
    known = np.sort(_key(sums ^ columns[0], ends))
    sums, starts, _ = _sums(columns, early)
    spans = np.zeros(longest + 1, np.int64)
    for first in range(1, longest):
        some = comb(first - 1, early)
        keys = _key(sums[:some] ^ columns[first], np.minimum(starts[:some], first))
        keys.sort()  # sorted keys are found several times as fast
        below = np.searchsorted(known, keys)
        spans[first + 1] = (below - np.searchsorted(known, keys & ~PLACE)).sum()
    return spans.cumsum().cumsum()


def _sums(columns: Syndromes, size: int) -> tuple[Syndromes, Few, Few]:
    """The sums over each `size` of the places 1 …, with their least and their greatest place.

    Ordered by the greatest, so that those below a place p are the first (p - 1 over size) ones.
    """
    sums = np.zeros(1, np.uint64)
    least, greatest = np.full(1, len(columns)), np.zeros(1, np.int64)
    places = np.arange(1, len(columns))
    for taken in range(size):
        counts = [comb(place - 1, taken) for place in places]
        sums = np.concatenate([sums[:n] ^ columns[p] for n, p in zip(counts, places, strict=True)])
        greatest = np.repeat(places, counts)
        least = np.minimum(np.concatenate([least[:n] for n in counts]), greatest)
    return sums, least, greatest


def _key(sums: Syndromes, places: Few) -> Syndromes:
    return sums << np.uint64(PLACE_BITS) | places.astype(np.uint64)
