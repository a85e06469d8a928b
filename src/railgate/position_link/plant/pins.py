"""Steps from pulses to pins: launched, delayed, disturbed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from railgate.position_link.plant.clk import Clk
from railgate.position_link.plant.words import Words, to_bits
from railgate.waves import Waveform
from railgate.waves.waveform import Ticks

__all__ = ["LOW", "delayed", "disturbed", "launched_data", "launched_uef"]

LOW = Waveform.of([0], [0])

BLOCK = 8192
"""Pulses whose bits are laid out at once."""


def launched_uef(clk: Clk, first: Ticks, end: Ticks) -> Waveform:
    """UEF of pulses from period `first` of CLK until `end`, in order and apart."""
    ticks = clk.launch(np.stack([first, end], axis=1).ravel())
    return _from_low(ticks, np.arange(ticks.size) % 2 == 0)


def launched_data(clk: Clk, first: Ticks, end: Ticks, words: Words, cycle: Ticks) -> Waveform:
    """DATA of these pulses, each with the word of its cycle."""
    ticks, levels = [np.empty(0, np.int64)], [np.empty(0, np.uint8)]
    for start in range(0, first.size, BLOCK):
        part = slice(start, start + BLOCK)
        size = np.minimum(end[part] - first[part], clk.config.word_bits)
        bits = np.zeros((size.size, clk.config.word_bits + 1), np.uint8)
        bits[:, :-1] = to_bits(words[cycle[part]], clk.config.word_bits)
        bits[np.arange(bits.shape[1]) >= size[:, None]] = 0
        changes = np.ones(bits.shape, np.bool_)
        changes[:, 1:] = bits[:, 1:] != bits[:, :-1]
        row, column = np.nonzero(changes)
        ticks.append(clk.launch(first[part][row] + column))
        levels.append(bits[changes])
    return _from_low(np.concatenate(ticks), np.concatenate(levels))


def _from_low(ticks: Ticks, levels: NDArray[np.uint8] | NDArray[np.bool_]) -> Waveform:
    return Waveform.of(np.append(0, ticks), np.append(np.uint8(0), levels))


def delayed(wave: Waveform, delay: Waveform, end: int) -> Waveform:
    """Holds in tick k < `end` what `wave` held in tick k - delay[k], before its beginning 0."""
    shift = delay.values.astype(np.int64)
    stop = np.append(delay.ticks[1:], end)
    # Of each stretch of one delay: the edges in it, and the level that it begins with.
    low = np.searchsorted(wave.ticks, delay.ticks - shift, side="right")
    high = np.maximum(np.searchsorted(wave.ticks, stop - shift, side="left"), low)
    count = high - low
    before = np.cumsum(count) - count
    edges = np.repeat(low - before, count) + np.arange(count.sum())
    level = np.where(low > 0, wave.values[low - 1], 0)
    ticks = np.insert(wave.ticks[edges] + np.repeat(shift, count), before, delay.ticks)
    return Waveform.of(ticks, np.insert(wave.values[edges], before, level))


def disturbed(wave: Waveform, flip: Waveform, low: Waveform, high: Waveform) -> Waveform:
    """A line's far end: inverted by `flip`, then held at 0 by `low`, then at 1 by `high`."""
    if all(by == LOW for by in (flip, low, high)):
        return wave
    ticks = np.sort(np.concatenate([each.ticks for each in (wave, flip, low, high)]), kind="stable")
    levels = (wave.at(ticks) ^ flip.at(ticks)) & (1 - low.at(ticks)) | high.at(ticks)
    return Waveform.of(ticks, levels)
