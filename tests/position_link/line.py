"""The line to a position link in the tests: answers by the contract's own arithmetic, and what the
link makes of them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any

from railgate.engines import Engine, open_engine
from railgate.engines.signals import parts
from railgate.position_link.design import design
from railgate.position_link.spec import Config
from railgate.waves import Trace, Waveform

SMALL: dict[str, Any] = {
    "clock_hz": 1_000_000,
    "bit_rate_hz": Fraction(100_000),
    "cycle_s": Fraction(1, 1250),
    "word_bits": 8,
    "timeout_bits": 6,
    "request_bits": 3,
    "filter_ticks": 1,
    "guard_ticks": 1,
}
"""10 ticks a bit, 80 bits a cycle."""

Spans = tuple[tuple[int, int], ...]


def small(**changes: Any) -> Config:
    return Config(**{**SMALL, **changes})


@dataclass(frozen=True)
class Piece:
    """Where the pins are high: start ≤ tick < stop of each span."""

    uef: Spans = ()
    data: Spans = ()


def begin(config: Config, cycle: int) -> int:
    """C of that cycle."""
    return 1 + cycle * config.cycle_ticks


def decision(config: Config, cycle: int) -> int:
    """Q of that cycle."""
    return begin(config, cycle) + config.decision_ticks


def answer(
    config: Config, cycle: int, word: int, at_bit: int, bits: int | None = None, delay: int = 0
) -> Piece:
    """The position system's answer: UEF from period `at_bit` of CLK on, for `bits` periods.

    word: the most significant of its word_bits bits first; UEF may be shorter or longer than it.
    delay: of both lines after the rising edges of CLK, ticks.
    """
    bits = config.word_bits if bits is None else bits
    edges = [begin(config, cycle) + config.rise(at_bit + i) + delay for i in range(bits + 1)]
    ones = [i for i in range(bits) if word << i >> config.word_bits - 1 & 1]
    data = tuple((edges[i], edges[i + 1]) for i in ones)
    return Piece(uef=((edges[0], edges[-1]),), data=data)


def high(spans: Iterable[tuple[int, int]], end: int) -> Waveform:
    """A pin over 0 ≤ tick < end that is 1 in any of the spans."""
    changes = sorted(change for start, stop in spans for change in ((start, 1), (stop, -1)))
    ticks, levels, depth = [0], [0], 0
    for tick, step in changes:
        depth += step
        ticks.append(max(tick, 0))
        levels.append(int(depth > 0))
    return Waveform.of(ticks, levels).slice(0, end)


def stimulus(config: Config, pieces: Iterable[Piece], end: int, reset: Spans = ()) -> Trace:
    """All pieces together; rst is 1 in the spans of `reset`."""
    pieces = list(pieces)
    waves = {
        "uef": high((span for piece in pieces for span in piece.uef), end),
        "data": high((span for piece in pieces for span in piece.data), end),
        "rst": high(reset, end),
    }
    return Trace(waves, Fraction(1, config.clock_hz), 0, end)


@cache
def opened(config: Config, kind: str) -> tuple[Engine, Any]:
    engine = open_engine(design(config), kind)
    return engine, engine.checkpoint()


def run(config: Config, cycles: int, *pieces: Piece, kind: str = "pysim") -> Trace:
    """What the link answers, up to the end of that many cycles."""
    engine, start = opened(config, kind)
    engine.restore(start)
    end = begin(config, cycles)
    return engine.advance(end, stimulus(config, pieces, end))


def fields(config: Config, result: Trace, tick: int) -> dict[str, int]:
    """The fields that are there in a tick."""
    return {
        field.name: sum(
            int(result[name].at(tick)) << offset
            for name, _, offset in parts(field.name, field.width)
        )
        for field in config.fields
    }


def deliveries(config: Config, result: Trace) -> list[dict[str, int]]:
    """The fields of each delivery."""
    return [fields(config, result, int(tick)) for tick in result["delivery"].rising()]


def frames(config: Config, result: Trace) -> list[int]:
    """The bits on the radio line while it is valid, as a number, read in the middle of each CLK."""
    read = []
    for cycle in range(1 + (result.end - 1) // config.cycle_ticks):
        middles = [begin(config, cycle) + config.fall(n) for n in range(config.cycle_bits)]
        middles = [tick for tick in middles if tick < result.end]
        valid = [tick for tick in middles if result["radio_valid"].at(tick)]
        if valid:
            read.append(int("".join(str(result["radio_data"].at(tick)) for tick in valid), 2))
    return read
