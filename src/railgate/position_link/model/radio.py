"""The radio line of the position link's model: frames, and where its data change (LNK-6)."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from railgate.position_link.model.link import COLUMNS, Table
from railgate.position_link.model.words import PART, Words, fields_of, parts_of
from railgate.position_link.spec import Config, Status
from railgate.waves.waveform import Ticks

__all__ = ["frames", "launch"]


def frames(config: Config, table: Table) -> Words:
    """The frame of each delivery, as `frame_fields` tell. Shape (deliveries, parts)."""
    named = dict(zip(COLUMNS, table.T, strict=False))
    words = table[:, COLUMNS.index("word") :].view(np.uint64)
    if config.bare:
        fresh = named["status"] == Status.FRESH
        return np.where(fresh[:, None], words, parts_of(config.invalid_word, config.word_bits))
    rest = config.frame_bits - config.word_bits
    made = np.zeros((len(table), -(-config.frame_bits // PART)), np.uint64)
    made[:, : words.shape[1]] = words << np.uint64(rest)
    made[:, 1:] |= words[:, : made.shape[1] - 1] >> np.uint64(PART - rest)
    tail = (named["status"] << config.age_bits | named["age"]) << 8 | named["number"] & 255
    check = config.radio_check
    made[:, 0] |= tail.astype(np.uint64) << np.uint64(check.width)
    made[:, 0] |= fields_of(check, made, config.frame_bits - check.width)
    return made


@njit(cache=True, nogil=True)
def launch(begins: Ticks, clocks: Ticks, made: Words) -> tuple[Ticks, NDArray[np.uint8]]:
    """The ticks in which the line changes, and to what, with one frame in each cycle.

    begins: the first tick of each cycle. clocks: ticks from there to the launch of each bit and to
    the end of the last one, shape (bits + 1,). made: the frames.
    """
    bits = clocks.size - 1
    ticks = np.empty(begins.size * clocks.size + 1, np.int64)
    levels, n = np.empty(ticks.size, np.uint8), 0
    for i in range(begins.size):
        level = np.uint64(0)
        for at in range(bits + 1):
            left, bit = bits - 1 - at, np.uint64(0)
            if left >= 0:
                bit = made[i, left >> 6] >> np.uint64(left & 63) & np.uint64(1)
            ticks[n], levels[n] = begins[i] + clocks[at], bit
            n += int(bit != level)  # else it is written over: a branch would be guessed wrong
            level = bit
    return ticks[:n], levels[:n]
