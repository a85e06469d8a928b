"""Many words at once, as rows of 64-bit parts, least significant first: checks and objections."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from railgate.position_link.spec import Cause, Check, Config

__all__ = ["PART", "Words", "fields_of", "numbers", "objections", "parts_of"]

Words = NDArray[np.uint64]
"""Shape (words, parts)."""

PART = 64
ONES = (1 << PART) - 1


def parts_of(word: int, bits: int) -> NDArray[np.uint64]:
    """The parts of one word of `bits` bits."""
    return np.array([word >> at & ONES for at in range(0, bits, PART)], np.uint64)


def numbers(words: Words) -> list[int]:
    """The words as numbers."""
    found = [0] * len(words)
    for part in reversed(words.T):
        found = [word << PART | low for word, low in zip(found, part.tolist(), strict=True)]
    return found


@njit(cache=True, nogil=True)
def remainders(
    words: Words, high: int, low: int, width: int, polynomial: np.uint64, initial: np.uint64
) -> NDArray[np.uint64]:
    """The register of a check (spec.Check) after the bits high > bit ≥ low of each word."""
    aside, top = np.uint64(64 - width), np.uint64(63)  # the register stands at the upper end
    found = np.empty(words.shape[0], np.uint64)
    for i in range(found.size):
        register = initial << aside
        for at in range(high - 1, low - 1, -1):
            bit = words[i, at >> 6] >> np.uint64(at & 63)
            out = (register >> top ^ bit) & np.uint64(1)
            register = register << np.uint64(1) ^ (polynomial << aside) * out
        found[i] = register >> aside
    return found


def fields_of(check: Check, words: Words, bits: int) -> NDArray[np.uint64]:
    """The field that belongs to the first `bits` bits of each word, all but its last `width`."""
    high, low = bits + check.width, check.width
    polynomial, initial = np.uint64(check.polynomial), np.uint64(check.initial)
    register = remainders(words, high, low, check.width, polynomial, initial)
    fields: NDArray[np.uint64] = register ^ np.uint64(check.final)
    return fields


def objections(config: Config, words: Words) -> NDArray[np.int64]:
    """The causes for which each complete word is none (LNK-5, LNK-7). Shape (words,)."""
    wrong = (words == parts_of(config.invalid_word, config.word_bits)).all(axis=1)
    causes: NDArray[np.int64] = wrong * np.int64(Cause.FAULT_WORD)
    if config.zero_is_fault:
        causes |= (words == 0).all(axis=1) * np.int64(Cause.ZERO_WORD)
    if check := config.check:
        wrong = words[:, 0] & np.uint64((1 << check.width) - 1) != fields_of(
            check, words, config.word_bits - check.width
        )
        causes |= wrong * np.int64(Cause.CHECK)
    return causes
