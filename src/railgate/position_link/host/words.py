"""Words of up to 512 bits as arrays: parts of 64 bits, the least significant first.

Ref: LNK-3, LNK-7, LNK-8.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from railgate.position_link.spec import Check, Config

__all__ = ["Words", "check_fields", "extract", "insert", "pack", "parted", "sound", "unpack"]

Words = NDArray[np.uint64]
"""Shape (n, parts); public functions take and return (n,) where a word has one part."""

PART = 64


def _parts(word_bits: int) -> int:
    return -(-word_bits // PART)


def parted(words: Words, word_bits: int) -> Words:
    """The words in shape (n, parts). Raises ValueError for another shape, and for a bit beyond."""
    parts = _parts(word_bits)
    found = np.asarray(words)
    if found.ndim == 1 and parts == 1:
        found = found[:, np.newaxis]
    if found.ndim != 2 or found.shape[1] != parts or found.dtype != np.uint64:
        raise ValueError(
            f"words of {word_bits} bits must be uint64 in {parts} columns, "
            f"not {found.dtype} of shape {np.shape(words)}"
        )
    if (top := word_bits % PART) and (found[:, -1] >> top).any():
        raise ValueError(f"a word must have at most {word_bits} bits, not more")
    return found


def pack(words: Sequence[int], word_bits: int) -> Words:
    """Numbers as words: shape (n,) up to 64 bits, else (n, parts). Raises ValueError."""
    parts = _parts(word_bits)
    for word in words:
        if not 0 <= word < 1 << word_bits:
            raise ValueError(f"a word must have {word_bits} bits, not be {word:#x}")
    raw = b"".join(word.to_bytes(8 * parts, "little") for word in words)
    found = np.frombuffer(raw, "<u8").astype(np.uint64).reshape(-1, parts)
    return found[:, 0] if parts == 1 else found


def unpack(words: Words) -> list[int]:
    """The words as numbers."""
    rows = words.astype("<u8").reshape(len(words), -1 if words.size else 1)
    return [int.from_bytes(row.tobytes(), "little") for row in rows]


def extract(words: Words, lsb: int, width: int) -> NDArray[np.uint64]:
    """`width` ≤ 64 bits of each word from bit `lsb` upwards. words: (n, parts)."""
    part, shift = divmod(lsb, PART)
    bits = words[:, part] >> np.uint64(shift)
    if shift + width > PART:
        bits |= words[:, part + 1] << np.uint64(PART - shift)
    return bits & np.uint64((1 << width) - 1)


def insert(words: Words, lsb: int, width: int, bits: NDArray[np.uint64]) -> None:
    """Sets `width` ≤ 64 bits of each word, zero so far, from bit `lsb` upwards."""
    part, shift = divmod(lsb, PART)
    words[:, part] |= bits << shift
    if shift + width > PART:
        words[:, part + 1] |= bits >> (PART - shift)


def check_fields(words: Words, word_bits: int, check: Check) -> NDArray[np.uint64]:
    """The check field that belongs to each word, as `Check.of` has it. words: (n, parts)."""
    register = np.full(len(words), check.initial, np.uint64)
    one, top = np.uint64(1), np.uint64(check.width - 1)
    mask, polynomial = np.uint64((1 << check.width) - 1), np.uint64(check.polynomial)
    for at in reversed(range(check.width, word_bits)):
        out = (register >> top) ^ extract(words, at, 1)
        register = (register << one) & mask ^ out * polynomial
    return register ^ np.uint64(check.final)


def sound(words: Words, config: Config) -> NDArray[np.bool_]:
    """Which words can be good ones: not the fault word, nor zero where that is none, and their
    check holds. words: (n, parts)."""
    false = pack([config.invalid_word, 0], config.word_bits).reshape(2, -1)
    good: NDArray[np.bool_] = (words != false[0]).any(axis=1)
    if config.zero_is_fault:
        good &= (words != false[1]).any(axis=1)
    if config.check:
        field = extract(words, 0, config.check.width)
        good &= field == check_fields(words, config.word_bits, config.check)
    return good
