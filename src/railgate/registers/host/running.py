"""A design that runs in an engine while a bus is at work: its pins, its clock, its time."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from fractions import Fraction
from math import ceil, floor, inf

from railgate.engines import Design, open_engine
from railgate.waves import Trace, Waveform

__all__ = ["Drive", "Running"]

Drive = tuple[int, Sequence[int]]
"""Width of an input, and its values in the first steps, of which the last one stays."""


class Running:
    """A design in an engine of one of ENGINES, step by step, from one edge of the clock of `domain`
    to the next.

    pins: what the inputs are driven with, in the design's time base; without them they stay 0. An
    input that a bus drives is the bus's alone. Raises ValueError.
    """

    def __init__(
        self, design: Design, engine: str, pins: Trace | None = None, domain: str = "sync"
    ) -> None:
        self._design = design
        self._pins = pins
        self._engine = open_engine(design, engine)
        clock = next(each for each in design.clocks if each.domain == domain)
        self._step = clock.period / design.period
        self._phase = clock.phase
        self._steps = 0
        self._last = None if pins is None else floor(pins.end / self._step - self._phase)

    @property
    def now(self) -> int:
        """The tick of the design up to which it has run."""
        return self._engine.now

    @property
    def left_s(self) -> Fraction | float:
        """Seconds to the end of the pins; inf without pins."""
        if self._pins is None:
            return inf
        return (self._pins.end - self.now) * self._design.period

    def steps(self, seconds: Fraction) -> int:
        """How many last so long, at least."""
        return ceil(seconds / (self._step * self._design.period))

    def run(
        self, inputs: Mapping[str, Drive], steps: int, outputs: Collection[str] | None = None
    ) -> Trace:
        """So many steps on, at most to the end of the pins. outputs: as of Engine.advance. Raises
        ValueError at the end of the pins."""
        last = self._steps + steps
        if self._last is not None:
            last = min(last, self._last)
        if last == self._steps:
            raise ValueError(f"the simulation of {self._design.name} is at its end")
        start, until = self._engine.now, self._tick(last)
        driven = {}
        for name, (width, values) in inputs.items():
            ticks = [self._tick(self._steps + n) for n in range(len(values))]
            inside = sum(tick < until for tick in ticks)
            driven[name] = Waveform.of(ticks[:inside], values[:inside], width)
        stimulus = Trace(driven, self._design.period, start, until)
        if self._pins is not None:
            others = [name for name in self._pins.signals if name not in driven]
            stimulus = self._pins.select(others).slice(start, until).merge(stimulus)
        told = self._engine.advance(until, stimulus, outputs)
        self._steps = last
        return told

    def _tick(self, step: int) -> int:
        """Where a step begins: with an edge, but the first one with tick 0."""
        return ceil((step + self._phase) * self._step) if step else 0
