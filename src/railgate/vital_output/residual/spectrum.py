"""How many errors of each weight pass a linear code, exactly, and how likely that is.

Either the code has few words, or its dual: those are made one and all, and the weights of the code
follow from the weights of the dual. Ref: MacWilliams, Sloane, The Theory of Error-Correcting Codes,
chapter 5, sections 2 and 7.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import fsum

import numpy as np
from numba import njit
from numpy.typing import NDArray

from railgate.vital_output.residual.linear import MOST, Syndromes, eliminate

__all__ = ["MOST_GENERATORS", "Spectrum", "probability", "spectrum"]

Spectrum = tuple[int, ...]
"""By weight, from 0: so many errors of this weight pass."""
MOST_GENERATORS = 33
"""2 to this power words are made in seconds."""
LOW = 10
"""Generators whose 2^10 sums stay in the processor's first cache."""
CHUNK = 14

Words = NDArray[np.uint64]


def spectrum(syndromes: Syndromes, told: Callable[[float], None] | None = None) -> Spectrum:
    """Of the code whose bits have these syndromes. told: hears the part done, now and then.

    Raises ValueError where neither the code nor its dual is small enough.
    """
    columns = [int(syndrome) for syndrome in syndromes]
    n = len(columns)
    rows = [sum((c >> bit & 1) << i for i, c in enumerate(columns)) for bit in range(MOST)]
    checks, _ = eliminate(rows)
    if n - len(checks) < len(checks):
        return _weights(eliminate(columns)[1], n, told)
    return _transformed(_weights(checks, n, told), len(checks))


def probability(passing: Spectrum, error_rate: float) -> float:
    """That bits wrong at this rate, each for itself, are an error and pass."""
    n, p = len(passing) - 1, error_rate
    return fsum(a * p**w * (1 - p) ** (n - w) for w, a in enumerate(passing) if w and a)


def _weights(generators: Sequence[int], n: int, told: Callable[[float], None] | None) -> Spectrum:
    """Of all sums of the generators, words of n bits."""
    if len(generators) > MOST_GENERATORS:
        raise ValueError(
            f"a code or its dual must have at most 2^{MOST_GENERATORS} words, "
            f"not 2^{len(generators)}"
        )
    size = -(-n // 64)
    parts = [[g >> 64 * i & (1 << 64) - 1 for i in range(size)] for g in generators]
    words = np.array(parts, np.uint64).reshape(-1, size)
    low, high = np.ascontiguousarray(_span(words[:LOW]).T), _span(words[LOW:])
    counts = np.zeros(64 * size + 1, np.int64)
    for done in range(0, len(high), 1 << CHUNK):
        _count(high[done : done + (1 << CHUNK)], low, counts)
        if told:
            told((done + (1 << CHUNK)) / len(high))
    return tuple(counts[: n + 1].tolist())


def _span(generators: Words) -> Words:
    words = np.zeros((1, generators.shape[1]), np.uint64)
    for generator in generators:
        words = np.concatenate([words, words ^ generator])
    return words


@njit(cache=True)  # type: ignore[untyped-decorator]
def _count(high: Words, low: Words, counts: NDArray[np.int64]) -> None:
    """Count the weights of all sums of a word of `high`, (words, 64 bits), and one of `low`,
    (64 bits, words). Both inner loops are such that the compiler takes several words at a time."""
    weights = np.zeros(low.shape[1], np.uint64)
    for i in range(high.shape[0]):
        weights[:] = 0
        for part in range(low.shape[0]):
            for j in range(low.shape[1]):
                x = high[i, part] ^ low[part, j]
                x -= x >> np.uint64(1) & np.uint64(0x5555555555555555)
                pairs = np.uint64(0x3333333333333333)
                x = (x & pairs) + (x >> np.uint64(2) & pairs)
                x = x + (x >> np.uint64(4)) & np.uint64(0x0F0F0F0F0F0F0F0F)
                weights[j] += x * np.uint64(0x0101010101010101) >> np.uint64(56)
        for j in range(low.shape[1]):
            counts[weights[j]] += 1


def _transformed(dual: Spectrum, rank: int) -> Spectrum:
    """The spectrum of the code whose dual, of 2^rank words, has that one: MacWilliams' identity."""
    n = len(dual) - 1
    totals = [0] * (n + 1)
    for i, words in enumerate(dual):
        before, krawtchouk = 0, 1
        for w in range(n + 1):
            totals[w] += words * krawtchouk
            following = (n - 2 * i) * krawtchouk - (n - w + 1) * before
            before, krawtchouk = krawtchouk, following // (w + 1)
    return tuple(total >> rank for total in totals)
