"""The outputs of the position link's model: waveforms made of deliveries and of time alone."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railgate.engines.columns import Columns
from railgate.engines.signals import parts
from railgate.position_link.model.link import COLUMNS, Table
from railgate.position_link.model.radio import frames, launch
from railgate.position_link.spec import Config
from railgate.waves import Waveform
from railgate.waves.waveform import Ticks

__all__ = ["Outputs", "Part"]

Changes = tuple[Ticks, NDArray[Any]]


@dataclass(frozen=True)
class Part:
    """A stretch without reset, start ≤ tick < end, whose tick 0 is `origin`.

    shown: the ticks of its deliveries, the first of which may lie before. table: their rows.
    """

    start: int
    end: int
    origin: int
    shown: Ticks
    table: Table

    def clip(self, ticks: Ticks, levels: NDArray[Any]) -> Changes:
        """The changes inside, first of all the level at the start; it is 0 before all of them."""
        first = int(np.searchsorted(ticks, self.start, side="right"))
        last = max(first, int(np.searchsorted(ticks, self.end, side="left")))
        level = levels[first - 1] if first else 0
        return np.append(self.start, ticks[first:last]), np.append(level, levels[first:last])


class Outputs:
    """Makes the waveforms of one configuration."""

    def __init__(self, config: Config) -> None:
        self._config = config
        shapes = {
            field.name: [(name, width, False) for name, width, _ in parts(field.name, field.width)]
            for field in config.fields
        }
        self._columns = Columns(shape for name in COLUMNS for shape in shapes[name])
        fields = [name for field in config.fields for name, *_ in shapes[field.name]]
        self.names = ("clk", "anf", "delivery", *fields, "radio_valid", "radio_data")
        first = config.radio_first
        launches = range(first, first + config.frame_bits + 1)
        self._launches = np.array([config.rise(n) for n in launches], np.int64)
        requested = min(config.rise(config.request_bits), config.cycle_ticks)
        self._marks = {
            "anf": np.array([0, requested]),
            "delivery": config.delivery_ticks + np.arange(2),
            "radio_valid": self._launches[[0, -1]],
        }

    def waves(self, stretches: list[Part], names: Collection[str]) -> dict[str, Waveform]:
        """The waveforms of that name, over all the stretches, one after the other."""
        ticks = join([np.maximum(part.shown, part.start) for part in stretches])
        table = join([part.table for part in stretches])
        waves = self._columns.waves(ticks, table, names)
        for name in ("clk", *self._marks):
            if name in names:
                marks = self._clock() if name == "clk" else self._marks[name]
                waves[name] = joined([self._repeat(part, marks) for part in stretches])
        if "radio_data" in names:
            waves["radio_data"] = joined([self._radio(part) for part in stretches])
        return {name: waves[name] for name in names}

    def _clock(self) -> Ticks:
        """Rise and fall of every period of CLK."""
        halves = np.arange(2 * self._config.cycle_bits)
        edges: Ticks = -(-halves * self._config.ticks // (2 * self._config.bits))
        return edges

    def _repeat(self, part: Part, marks: Ticks) -> Changes:
        """What rises and falls in turn, so many ticks from the beginning of every cycle."""
        length, begin = self._config.cycle_ticks, part.origin + 1
        first = (part.start - begin) // length
        last = (max(part.start, part.end - 1) - begin) // length
        begins = begin + length * np.arange(max(first, 0), last + 1)
        ticks = (begins[:, None] + marks).ravel()
        return part.clip(ticks, np.arange(ticks.size) % 2 == 0)

    def _radio(self, part: Part) -> Changes:
        begins = part.shown - self._config.delivery_ticks
        delivered = begins > part.origin  # all but the one of start
        made = frames(self._config, part.table[delivered])
        return part.clip(*launch(begins[delivered], self._launches, made))


def joined(changes: list[Changes]) -> Waveform:
    ticks, levels = zip(*changes, strict=True)
    return Waveform.of(join(ticks), join(levels))


def join(arrays: Sequence[NDArray[Any]]) -> NDArray[Any]:
    return arrays[0] if len(arrays) == 1 else np.concatenate(arrays)
