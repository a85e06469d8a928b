"""Words as arrays of bits, their checks, and the words of a train that runs along."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from railgate.position_link.spec import Check, Config, Field
from railgate.waves.waveform import MAX_WIDTH

__all__ = ["LAYOUT", "Bits", "Words", "checks", "from_bits", "of_train", "row", "to_bits"]

Words = NDArray[np.uint64]
"""Shape (n, parts): 64 bits in each part, the least significant part first."""

Bits = NDArray[np.uint8]
"""Shape (n, bits): one bit in each, the most significant one first."""

LAYOUT = (
    Field("sequence", 12, "number of the cycle, modulo its width"),
    Field("speed", 12, "of the train", "dm/s"),
    Field("position", 40, "on the line, modulo its width", "mm"),
)
"""An example of a word, the most significant field first. A narrower word has its low bits, a wider
one zeros before it; a word with a check has that behind it."""

SWING_S, SWING = 60.0, 0.05
"""The train's speed swings so slowly and so far about its mean, as a part of it."""


def to_bits(words: Words, width: int) -> Bits:
    """The low `width` bits of each word."""
    octets = np.ascontiguousarray(words[:, ::-1]).astype(">u8").view(np.uint8)
    return np.unpackbits(octets, axis=1)[:, -width:]


def from_bits(bits: Bits) -> Words:
    """The words that these bits are, in as many parts as they need."""
    width = -(-bits.shape[1] // MAX_WIDTH) * MAX_WIDTH
    full = np.zeros((bits.shape[0], width), np.uint8)
    full[:, width - bits.shape[1] :] = bits
    return np.packbits(full, axis=1).view(">u8").astype(np.uint64)[:, ::-1]


def row(number: int, config: Config) -> Words:
    """One word of the configuration's width, shape (parts,)."""
    parts = -(-config.word_bits // MAX_WIDTH)
    return np.frombuffer(number.to_bytes(8 * parts, "little"), "<u8").astype(np.uint64)


def checks(check: Check, bits: Bits) -> Words:
    """The check of each row, shape (n, 1); see Check."""
    register = np.full(bits.shape[0], check.initial, np.uint64)
    top, mask = np.uint64(check.width - 1), np.uint64((1 << check.width) - 1)
    for bit in bits.T:
        out = (register >> top) ^ bit
        register = (register << np.uint64(1) & mask) ^ out * np.uint64(check.polynomial)
    found: Words = register ^ np.uint64(check.final)
    return found[:, None]


def of_train(config: Config, cycles: int, speed_kmh: float, seed: int) -> Words:
    """The words of a smooth run at about this speed, in LAYOUT, with their check; none is a fault.

    speed_kmh: 0 … 1000. seed: of the place at the start and the phase of the speed's swing.
    """
    random = np.random.default_rng(seed)
    start_m, phase = random.uniform(0, 1e6), random.uniform(0, 2 * np.pi)
    t = np.arange(cycles) * float(config.cycle_s)
    rate, mean = 2 * np.pi / SWING_S, speed_kmh / 3.6
    speed = mean * (1 + SWING * np.cos(rate * t + phase))
    way = mean * (t + SWING / rate * (np.sin(rate * t + phase) - np.sin(phase)))
    values = (np.arange(cycles), 10 * speed, 1000 * (start_m + way))
    packed = np.zeros(cycles, np.uint64)
    for field, value in zip(LAYOUT, values, strict=True):
        low = np.asarray(value).astype(np.uint64) & np.uint64((1 << field.width) - 1)
        packed = packed << np.uint64(field.width) | low
    return _valid(config, packed)


def _valid(config: Config, payloads: NDArray[np.uint64]) -> Words:
    """The payloads as words; the next payload where that were the fault word or zero."""
    never = np.stack([row(config.invalid_word, config), row(0, config)])
    while True:
        words = _words(config, payloads)
        odd = (words[:, None] == never).all(axis=2).any(axis=1)
        if not odd.any():
            return words
        payloads = payloads + odd


def _words(config: Config, payloads: NDArray[np.uint64]) -> Words:
    """The low bits of the payloads as words with their check."""
    check = config.check
    bits = np.zeros((payloads.size, config.word_bits - (check.width if check else 0)), np.uint8)
    low = to_bits(payloads[:, None], min(bits.shape[1], MAX_WIDTH))
    bits[:, bits.shape[1] - low.shape[1] :] = low
    if check is None:
        return from_bits(bits)
    return from_bits(np.concatenate([bits, to_bits(checks(check, bits), check.width)], axis=1))
