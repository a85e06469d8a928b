"""The edges of CLK over a whole run, vectorised."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from railgate.position_link.spec import Config, Edge
from railgate.waves.waveform import Ticks

__all__ = ["Clk"]


@dataclass(frozen=True)
class Clk:
    """CLK from tick 0 on; its periods are numbered 0, 1, … through all cycles. Ref: LNK-1."""

    config: Config

    def begin(self, cycles: Ticks) -> Ticks:
        """The tick C of each of the cycles."""
        return 1 + cycles * self.config.cycle_ticks

    def rise(self, periods: Ticks) -> Ticks:
        """The ticks of the rising edges of these periods."""
        cycles, n = np.divmod(periods, self.config.cycle_bits)
        ticks: Ticks = self.begin(cycles) - (-n * self.config.ticks // self.config.bits)
        return ticks

    def fall(self, periods: Ticks) -> Ticks:
        """The ticks of the falling edges of these periods."""
        cycles, n = np.divmod(periods, self.config.cycle_bits)
        halves = (-2 * n - 1) * self.config.ticks // (2 * self.config.bits)
        ticks: Ticks = self.begin(cycles) - halves
        return ticks

    def launch(self, periods: Ticks) -> Ticks:
        """The ticks in which what is launched with these periods is new."""
        rising = self.config.sampling_edge == Edge.FALLING
        return 1 + (self.rise(periods) if rising else self.fall(periods))

    def falls_before(self, ticks: Ticks) -> Ticks:
        """So many falling edges are in the ticks before each of `ticks`, which are 1 or more."""
        cycles, at = np.divmod(ticks - 1, self.config.cycle_ticks)
        period, bits = self.config.ticks, self.config.bits
        here = (2 * bits * (at - 1) + period) // (2 * period)
        found: Ticks = cycles * self.config.cycle_bits + here
        return found
