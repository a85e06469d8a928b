"""A captured line read as a sniffer would: words and faults, by the model's own reader."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from railgate.position_link.host import Layout, guarantee
from railgate.position_link.model import Answer, Reading, read_line
from railgate.position_link.spec import Config, cause_names
from railgate.waves import Trace

__all__ = ["Decoded", "decode", "word_text"]


def word_text(word: int, word_bits: int) -> str:
    """A word in JSON and tables: `0x…` with all its digits."""
    return f"{word:#0{-(-word_bits // 4) + 2}x}"


@dataclass(frozen=True)
class Decoded:
    """What a captured line says. line: `clk`, `uef`, `data`, where captured `anf`, as read."""

    line: Trace
    config: Config
    layout: Layout | None
    reading: Reading

    @cached_property
    def answers(self) -> tuple[Answer, ...]:
        return tuple(self.reading)

    def values(self, answer: Answer) -> Mapping[str, float]:
        """The layout's fields of an answer that nothing speaks against; else none."""
        if self.layout is None or answer.word is None or answer.causes:
            return {}
        return self.layout.decode(answer.word)

    def time_s(self, tick: int) -> float:
        return float(tick * self.line.period)

    @property
    def good(self) -> int:
        """How many answers are words that nothing speaks against."""
        return sum(not answer.causes for answer in self.answers)

    @property
    def counts(self) -> dict[str, int]:
        """How many answers have each cause."""
        counted = Counter(name for answer in self.answers for name in cause_names(answer.causes))
        return {name: counted[name] for name in cause_names()}

    def as_json(self) -> dict[str, Any]:
        """All but the waves, as plain numbers, strings and lists; see docs/commands.md."""
        return {
            "duration_s": float(self.line.duration_s),
            "bit_rate_hz": self.reading.bit_rate_hz,
            "clock_stops": self.reading.clock_stops,
            "requests": self.reading.requests,
            "word_bits": self.config.word_bits,
            "good": self.good,
            "cut": self.reading.cut,
            "causes": self.counts,
            "guarantee": guarantee(self.config.check),
            "answers": [self._told(answer) for answer in self.answers],
        }

    def _told(self, answer: Answer) -> dict[str, Any]:
        word = answer.word
        return {
            "t_s": self.time_s(answer.tick),
            "uef_s": None if answer.rise is None else self.time_s(answer.rise),
            "bits": answer.bits,
            "word": None if word is None else word_text(word, self.config.word_bits),
            "causes": list(cause_names(answer.causes)),
            "values": dict(self.values(answer)),
        }


def decode(
    line: Trace, config: Config, layout: Layout | None = None, filter_ticks: int = 0
) -> Decoded:
    """Read a captured line.

    line: signals `clk`, `uef`, `data` and, where requests are captured, `anf`, 1 bit each, in any
    time base. config: cycle, window, word and what is no word count; the clock only for
    guard_ticks. filter_ticks: levels of at most so many of the capture's ticks are none. Raises
    ValueError.
    """
    for name, wave in line.signals.items():
        if wave.width != 1:
            raise ValueError(f'"{name}" must be 1 bit wide, not {wave.width}')
    reading = read_line(
        line["clk"],
        line["uef"],
        line["data"],
        config,
        line.period,
        (line.start, line.end),
        line.signals.get("anf"),
        filter_ticks,
    )
    return Decoded(line, config, layout, reading)
