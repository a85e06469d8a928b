"""Parts of the vital output's gateware on the bench: driven and read tick by tick."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from fractions import Fraction

from amaranth.lib import wiring

from railgate.engines import Clock, Design, open_engine
from railgate.engines.ports import ports
from railgate.waves import Trace, Waveform

__all__ = ["Bench", "high", "pulses", "values"]

Changes = Mapping[int, int]
"""Ticks from which on a signal has the values; it is 0 before."""


class Bench:
    """A component in an engine; a tick is a second."""

    def __init__(self, component: wiring.Component, kind: str = "cxxrtl") -> None:
        clocks = (Clock(frequency_hz=Fraction(1)),)
        self._widths = {port.name: port.width for port in ports(component, clocks)}
        design = Design(name="bench", component=lambda: component, clocks=clocks)
        self.engine = open_engine(design, kind)
        self._start = self.engine.checkpoint()

    def run(self, end: int, inputs: Mapping[str, Changes], *outputs: str) -> Trace:
        """The outputs, all if none is named, over the ticks 0 … end - 1, from reset."""
        self.engine.restore(self._start)
        return self.go_on(end, inputs, *outputs)

    def go_on(self, end: int, inputs: Mapping[str, Changes], *outputs: str) -> Trace:
        """The same from where the engine is."""
        waves = {name: self._wave(name, end, changes) for name, changes in inputs.items()}
        return self.engine.advance(end, Trace(waves, Fraction(1), 0, end), outputs or None)

    def _wave(self, name: str, end: int, changes: Changes) -> Waveform:
        there = {0: 0, **changes}
        ticks = sorted(there)
        wave = Waveform.of(ticks, [there[tick] for tick in ticks], self._widths[name])
        return wave.slice(0, end)


def pulses(ticks: Mapping[int, int] | Collection[int]) -> dict[int, int]:
    """A value, 1 where none is told, in just these ticks."""
    told = dict(ticks) if isinstance(ticks, Mapping) else dict.fromkeys(ticks, 1)
    return {tick + 1: 0 for tick in told} | told


def values(result: Trace, name: str) -> list[int]:
    """What an output holds in each tick of the result."""
    found: list[int] = result[name].at(range(result.start, result.end)).tolist()
    return found


def high(result: Trace, name: str) -> list[int]:
    """The ticks in which an output is not 0."""
    return [tick for tick, value in enumerate(values(result, name), result.start) if value]
