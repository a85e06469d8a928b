"""What position system and line do in each cycle and tick, and the pins that come of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np

from railgate.engines.signals import parts
from railgate.position_link.plant.clk import Clk
from railgate.position_link.plant.pins import (
    LOW,
    delayed,
    disturbed,
    launched_data,
    launched_uef,
)
from railgate.position_link.plant.words import Words
from railgate.position_link.spec import Config
from railgate.waves import Trace, Waveform
from railgate.waves.waveform import Ticks

__all__ = ["DELAY_BITS", "LINES", "Plan", "behaviour"]

DELAY_BITS = 8
DISTURBANCES = ("flip", "low", "high")
LINES = tuple(f"line.{pin}.{what}" for pin in ("uef", "data") for what in DISTURBANCES)


def behaviour(config: Config) -> dict[str, int]:
    """The inputs that tell the position system what to do, and the width of each."""
    width = config.cycle_bits.bit_length()
    clk = dict.fromkeys(("latency", "length", "second", "second_length"), width)
    return {"word": config.word_bits} | clk | {"delay": DELAY_BITS}


@dataclass(frozen=True, kw_only=True, eq=False)
class Plan:
    """What is done in each of n cycles, from tick 0 to the end of the last one.

    words: shape (n, parts), of 64 bits each, the least significant part first. latency, length,
    second, second_length, delay: shape (n,), see the package. lines: by names of LINES, from tick
    0 on; one that is not there is 0. Raises ValueError.
    """

    config: Config
    words: Words
    latency: Ticks
    length: Ticks
    second: Ticks
    second_length: Ticks
    delay: Ticks
    lines: Mapping[str, Waveform] = field(default_factory=dict)

    def __post_init__(self) -> None:
        most = self.config.cycle_bits
        bounds = dict.fromkeys(("latency", "length", "second", "second_length"), most)
        for name, high in {**bounds, "delay": (1 << DELAY_BITS) - 1}.items():
            values = getattr(self, name)
            odd = values[(values < 0) | (values > high)]
            if odd.size:
                raise ValueError(f"{name} must be between 0 and {high}, not {odd[0]}")
        if odd_names := self.lines.keys() - set(LINES):
            raise ValueError(f"a line must be one of {', '.join(LINES)}, not {min(odd_names)}")

    @property
    def cycles(self) -> int:
        return self.latency.size

    @property
    def end(self) -> int:
        """The tick in which the cycle after the last one begins."""
        return 1 + self.cycles * self.config.cycle_ticks

    def controls(self) -> Trace:
        """The inputs `system.word`, …, `line.uef.flip`, … of gateware.Plant, and of a Loop."""
        begins = self._begins()
        signals = {}
        for name, width in behaviour(self.config).items():
            values = self.words if name == "word" else getattr(self, name)[:, None]
            for part, (full, wide, _) in enumerate(parts(f"system.{name}", width)):
                signals[full] = Waveform.of(begins, values[:, part], wide)
        return self._trace(signals | {name: self.lines.get(name, LOW) for name in LINES})

    def drive(self) -> Trace:
        """The link's pins `uef`, `data`."""
        clk, delay = Clk(self.config), Waveform.of(self._begins(), self.delay, DELAY_BITS)
        cycle, first, end = self._pulses()
        launched = {
            "uef": launched_uef(clk, first, end),
            "data": launched_data(clk, first, end, self.words, cycle),
        }
        signals = {}
        for pin, wave in launched.items():
            by = (self.lines.get(f"line.{pin}.{what}", LOW) for what in DISTURBANCES)
            signals[pin] = disturbed(delayed(wave, delay, self.end), *by)
        return self._trace(signals)

    def _trace(self, signals: dict[str, Waveform]) -> Trace:
        return Trace(signals, Fraction(1, self.config.clock_hz), 0, self.end)

    def _begins(self) -> Ticks:
        """The ticks from which on the cycles are told: each one's first, of the first tick 0."""
        begins = Clk(self.config).begin(np.arange(self.cycles))
        begins[:1] = 0
        return begins

    def _pulses(self) -> tuple[Ticks, Ticks, Ticks]:
        """Of each pulse of UEF its cycle, the period of CLK it begins with, and the one after it.

        They are in order of time.
        """
        number = np.concatenate([self.second, self.latency])
        length = np.concatenate([self.second_length, self.length])
        cycle = np.tile(np.arange(self.cycles), 2)
        there = np.flatnonzero((number > 0) & (length > 0))
        begin = cycle * self.config.cycle_bits + number - 1
        # The sort is stable: of two that begin together the answer comes last, and ends the other.
        there = there[np.argsort(begin[there], kind="stable")]
        cycle, begin, length = cycle[there], begin[there], length[there]
        end = np.minimum(begin + length, (cycle + 1) * self.config.cycle_bits)
        end[:-1] = np.minimum(end[:-1], begin[1:])
        lasts = end > begin
        return cycle[lasts], begin[lasts], end[lasts]
