"""The compiled engine's speed on the odometer, against the reference simulator and Verilator."""

from __future__ import annotations

import time
from collections.abc import Callable
from fractions import Fraction
from statistics import median
from tempfile import TemporaryDirectory
from unittest.mock import patch

import numpy as np

from bench.row import Row, row
from bench.verilator import Verilated
from railgate.engines import Design, Engine, open_engine
from railgate.odometer.design import design
from railgate.odometer.spec import Config
from railgate.waves import Trace, Waveform

__all__ = ["run"]

ROUNDS = 7
TICKS = 4_000_000
PYSIM_TICKS = 20_000
PULSES_HZ = Fraction(5441)
STROBE_TICKS = 320_000


def run() -> list[Row]:
    """Rows of name, value, unit, goal, met; goal and met are None where a row only informs.

    One sensor at 200 km/h, 16 MHz, a snapshot each 20 ms; all outputs recorded, interleaved runs,
    medians. Raises AssertionError where two simulators disagree.
    """
    odometer = design(Config(sensors=1))
    stimulus = wheel(odometer, TICKS)
    built = {"cxxrtl": built_in(lambda: open_engine(odometer, "cxxrtl"))}
    built["Verilator"] = built_in(lambda: Verilated(odometer))
    seconds: dict[str, list[float]] = {"cxxrtl": [], "Verilator": [], "pysim": []}
    for _ in range(ROUNDS):
        engines = {"cxxrtl": open_engine(odometer, "cxxrtl"), "Verilator": Verilated(odometer)}
        results = [
            timed(engine, TICKS, stimulus, seconds[name]) for name, engine in engines.items()
        ]
        assert results[0] == results[1], results[0].first_difference(results[1])
        short = timed(open_engine(odometer, "pysim"), PYSIM_TICKS, stimulus, seconds["pysim"])
        assert short == results[0].slice(0, PYSIM_TICKS)
    ticks = {"cxxrtl": TICKS, "Verilator": TICKS, "pysim": PYSIM_TICKS}
    rates = {name: [ticks[name] / s for s in runs] for name, runs in seconds.items()}
    rows = [
        ratio("cxxrtl against pysim", rates["cxxrtl"], rates["pysim"], 200),
        ratio("cxxrtl against Verilator", rates["cxxrtl"], rates["Verilator"], 1.2),
    ]
    rows += [row(f"{name}, odometer", median(r), "ticks/s") for name, r in rates.items()]
    rows += [row(f"{name}, time to build", s, "s") for name, s in built.items()]
    return rows


def built_in(build: Callable[[], object]) -> float:
    """Seconds, with an empty cache."""
    with TemporaryDirectory() as empty, patch("platformdirs.user_cache_dir", return_value=empty):
        start = time.perf_counter()
        build()
        return time.perf_counter() - start


def wheel(odometer: Design, ticks: int) -> Trace:
    """Quadrature of one wheel at a constant speed, and the CPU's strobe, both of half duty."""
    quarter = 1 / odometer.period / PULSES_HZ / 4
    count = int(ticks / quarter)
    at = np.array([int(k * quarter) for k in range(1, count)], np.int64)
    strobes = np.arange(STROBE_TICKS, ticks, STROBE_TICKS)
    signals = {
        "sensor.0.a": pulses(at[0::2]),
        "sensor.0.b": pulses(at[1::2]),
        "strobe": pulses(np.column_stack([strobes, strobes + 1]).ravel()),
    }
    return Trace(signals, odometer.period, 0, ticks)


def pulses(at: np.ndarray) -> Waveform:
    """0, then toggling at these ticks."""
    return Waveform(np.concatenate([[0], at]), np.arange(at.size + 1) % 2)


def timed(engine: Engine, until: int, stimulus: Trace, seconds: list[float]) -> Trace:
    start = time.perf_counter()
    result = engine.advance(until, stimulus)
    seconds.append(time.perf_counter() - start)
    return result


def ratio(name: str, ours: list[float], theirs: list[float], least: float) -> Row:
    """The median of the ratios of neighbouring runs, so that both felt the same load."""
    return row(name, median(a / b for a, b in zip(ours, theirs, strict=True)), "×", least=least)
