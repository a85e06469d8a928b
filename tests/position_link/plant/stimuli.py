"""What drives a plant in the tests: configurations small enough to run, their CLK, and any plan."""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
from hypothesis import strategies as st

from railgate.engines import Clock, Design, Engine, open_engine
from railgate.position_link.plant import FAULTS, Fault, Plan, Scenario
from railgate.position_link.plant.plan import LINES
from railgate.position_link.spec import Check, Config, Edge
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
"""80 CLK of 10 ticks in a cycle."""

CONFIGS = (
    Config(**SMALL),
    Config(**SMALL, sampling_edge=Edge.RISING, bare=True),
    Config(
        **SMALL
        | {
            "bit_rate_hz": Fraction(80_000),
            "cycle_s": Fraction(1, 400),
            "word_bits": 70,
            "check": Check(width=5, polynomial=0x15, initial=0x1F, final=0x0A),
        }
    ),
    Config(
        **SMALL
        | {"bit_rate_hz": Fraction(95_000), "cycle_s": Fraction(1, 1000), "timeout_bits": 1}
        | {"request_bits": 1, "earliest_clk": 1},
        sampling_edge=Edge.RISING,
    ),
)
"""A whole and a broken number of ticks in a CLK, both edges, a wide word, a bare one."""


def clock_lines(config: Config, cycles: int) -> Trace:
    """CLK and ANF by the specification, edge by edge."""
    begins = [1 + c * config.cycle_ticks for c in range(cycles)]
    clk, anf = {0: 0}, {0: 0}
    for begin in begins:
        for n in range(config.cycle_bits):
            clk |= {begin + config.rise(n): 1, begin + config.fall(n): 0}
        anf |= {begin: 1, begin + config.rise(config.request_bits): 0}
    end = 1 + cycles * config.cycle_ticks
    waves = {"clk": clk, "anf": anf}
    signals = {name: Waveform.of(list(w), list(w.values())) for name, w in waves.items()}
    return Trace(signals, Fraction(1, config.clock_hz), 0, end)


@cache
def opened(kind: str, config: Config) -> tuple[Engine, Any]:
    """A plant in an engine that is built once, and its state at tick 0."""
    from railgate.position_link.plant.gateware import Plant

    clocks = (Clock(frequency_hz=Fraction(config.clock_hz)),)
    plant = Design(name="plant", component=lambda: Plant(config), clocks=clocks)
    engine = open_engine(plant, kind)
    return engine, engine.checkpoint()


def through(kind: str, config: Config, inputs: Trace) -> Trace:
    engine, start = opened(kind, config)
    engine.restore(start)
    return engine.advance(inputs.end, inputs)


def levels(ticks: list[int]) -> Waveform:
    """0 at first, another level with each of the ticks."""
    return Waveform.of([0, *sorted(ticks)], np.arange(len(ticks) + 1) & 1)


@st.composite
def plans(draw: st.DrawFn, config: Config, most_cycles: int = 5) -> Plan:
    """Any plan: mostly answers that fit, pulses anywhere, disturbances anywhere."""
    n = draw(st.integers(1, most_cycles))
    end = n * config.cycle_ticks
    near = st.integers(0, config.window_bits + config.word_bits)
    number = st.one_of(near, st.integers(0, config.cycle_bits))
    part = st.one_of(st.sampled_from((0, (1 << 64) - 1)), st.integers(0, (1 << 64) - 1))
    wide = range(0, config.word_bits, 64)
    words = [
        [draw(part) & (1 << min(64, config.word_bits - at)) - 1 for at in wide] for _ in range(n)
    ]
    columns = {
        name: np.array(draw(st.lists(values, min_size=n, max_size=n)), np.int64)
        for name, values in (
            ("latency", number),
            ("length", st.one_of(st.just(config.word_bits), number)),
            ("second", st.one_of(st.just(0), number)),
            ("second_length", number),
            ("delay", st.one_of(st.integers(0, 3), st.integers(0, 255))),
        )
    }
    changes = st.lists(st.integers(1, end), unique=True, max_size=6)
    lines = {name: levels(draw(changes)) for name in draw(st.sets(st.sampled_from(LINES)))}
    return Plan(config=config, words=np.array(words, np.uint64), lines=lines, **columns)


@st.composite
def faults(draw: st.DrawFn, config: Config, cycles: int) -> Fault:
    """Any kind, anywhere in the run, with its default or a small value."""
    kind = draw(st.sampled_from(tuple(FAULTS)))
    ticks = draw(st.integers(0, cycles * config.cycle_ticks - 1))
    start = Fraction(ticks, config.clock_hz)
    span = draw(st.none() | st.integers(1, 2 * config.cycle_ticks))
    end = None if span is None else start + Fraction(span, config.clock_hz)
    low, high = {"stuck": (0, 1), "drift": (-20, 20)}.get(kind, (1, 8))
    given = FAULTS[kind].value and draw(st.booleans())
    value = draw(st.integers(low, high)) if given else None
    return Fault(kind, start, end, value)


@st.composite
def scenarios(draw: st.DrawFn, config: Config, cycles: int) -> Scenario:
    found = draw(st.lists(faults(config, cycles), max_size=5))
    return Scenario(
        faults=tuple(found),
        seed=draw(st.integers(0, 3)),
        delay_ticks=draw(st.integers(60, 180)),
        latency_clk=draw(st.none() | st.integers(0, config.window_bits)),
    )
