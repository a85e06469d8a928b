"""The ticks of a clock's domain on the time base of several clocks, femtoseconds."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import ceil, lcm

import numpy as np
from numpy.typing import ArrayLike

from railgate.engines import Clock
from railgate.waves import Waveform
from railgate.waves.waveform import Ticks

__all__ = ["FEMTOSECOND", "MICROSECOND", "Edges", "femtoseconds", "multiples"]

FEMTOSECOND = Fraction(1, 10**15)
"""Seconds."""

MICROSECOND = 10**9
"""Femtoseconds."""

LARGEST = (1 << 63) - 1


def femtoseconds(seconds: Fraction) -> int:
    """The first whole femtosecond not before this time."""
    return ceil(seconds / FEMTOSECOND)


def multiples(step_s: Fraction, offset_s: Fraction, count: int) -> list[int]:
    """The first whole femtosecond not before offset + n · step, for n = 0, 1, …, count - 1."""
    step, offset = step_s / FEMTOSECOND, offset_s / FEMTOSECOND
    unit = lcm(step.denominator, offset.denominator)
    up, first = int(step * unit), int(offset * unit)
    return [-(-(first + n * up) // unit) for n in range(count)]


@dataclass(frozen=True)
class Edges:
    """Tick n of the clock's domain lasts from its edge n - 1 to its edge n, tick 0 from the start.

    Edges are where railgate.engines.Design has them; all is exact.
    """

    clock: Clock

    @cached_property
    def _scale(self) -> tuple[int, int, int]:
        """Edge n is in femtosecond ⌈(first + n · step) / unit⌉."""
        step = self.clock.period / FEMTOSECOND
        first = (1 + Fraction(self.clock.phase)) * step
        unit = lcm(step.denominator, first.denominator)
        return int(first * unit), int(step * unit), unit

    def begin(self, ticks: ArrayLike) -> Ticks:
        """The femtosecond with which each of these ticks begins."""
        first, step, unit = self._scale
        n = np.asarray(ticks, dtype=np.int64)
        whole, rest = divmod(step, unit)
        fits = int(n.max(initial=0)) * rest + first < LARGEST
        m = n - 1 if fits else n.astype(object) - 1
        begun: Ticks = np.where(n > 0, m * whole - -(first + m * rest) // unit, 0).astype(np.int64)
        return begun

    def during(self, times: ArrayLike) -> Ticks:
        """The tick in which each of these femtoseconds lies."""
        first, step, unit = self._scale
        k = np.asarray(times, dtype=np.int64)
        edge = np.floor((k - first / unit) / (step / unit)).astype(np.int64)  # or one beside it
        ticks: Ticks = np.maximum(edge, 0)
        for _ in range(2):
            ticks = ticks + (self.begin(ticks + 1) <= k)
        return ticks

    def first(self, times: ArrayLike) -> Ticks:
        """The first tick that begins not before each of these femtoseconds."""
        ticks = self.during(times)
        return ticks + (self.begin(ticks) < np.asarray(times, dtype=np.int64))

    def count(self, end: int) -> int:
        """How many ticks have begun before the femtosecond `end`, which is above 0."""
        return 1 + int(self.during(end - 1))

    def counted(self, ticks: ArrayLike, frequency_hz: int) -> Ticks:
        """How many periods of another clock, begun with the run, have passed by the edge with
        which each of these ticks begins (of tick 0 as if there were one), rounded."""
        step = self.clock.period * frequency_hz
        first = Fraction(self.clock.phase) * step
        unit = 2 * lcm(step.denominator, first.denominator)
        exact = np.asarray(ticks, np.int64).astype(object) * int(step * unit) + int(first * unit)
        counts: Ticks = ((exact + unit // 2) // unit).astype(np.int64)
        return counts

    def wave(self, ticks: ArrayLike, values: ArrayLike, width: int, end: int) -> Waveform:
        """A signal that changes with the beginning of these ticks, in femtoseconds below `end`.

        ticks: in order, from 0 on; of equal ones the last counts.
        """
        times = self.begin(ticks)
        seen = times < end
        return Waveform.of(times[seen], np.asarray(values)[seen], width)

    def sampled(self, wave: Waveform) -> Waveform:
        """What an edge of the clock finds at the end of each tick, in ticks."""
        return Waveform.of(self.during(wave.ticks), wave.values, wave.width)
