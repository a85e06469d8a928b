"""Stimuli step by step, and mutants of the vital output's gateware."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from amaranth.hdl import Shape, ShapeLike

from railgate.proving import TICK, Mutant, Run, Search
from railgate.waves import Trace, Waveform

__all__ = ["SEARCH", "Step", "mutant", "trace", "train"]

Step = tuple[int, Mapping[str, int]]
"""For so many ticks these inputs have these values, all others 0."""


def trace(widths: Mapping[str, ShapeLike], steps: Sequence[Step]) -> Trace:
    """The inputs of these widths, or shapes, step after step."""
    starts, now = [], 0
    for ticks, _ in steps:
        starts.append(now)
        now += ticks
    waves = {}
    for name, width in widths.items():
        values, shape = [told.get(name, 0) for _, told in steps], Shape.cast(width)
        waves[name] = Waveform.of(starts, values, shape.width, shape.signed)
    return Trace(waves, TICK, 0, now)


def train(period: int, periods: int, name: str, beside: Mapping[str, int]) -> Iterator[Step]:
    """So many periods of a pulse train on this input, others beside it."""
    for _ in range(periods):
        yield period // 2, {name: 1, **beside}
        yield period - period // 2, beside


SEARCH = Search()


def mutant(name: str, file: str, old: str, new: str, rejected: Search | Run = SEARCH) -> Mutant:
    """One of a file of the vital output's gateware."""
    return Mutant(name, f"railgate.vital_output.gateware.{file}", old, new, rejected)
