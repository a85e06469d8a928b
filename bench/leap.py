"""The model against the faster of two RTL simulators, and their equality over 10⁹ ticks."""

from __future__ import annotations

import hashlib
import statistics
import time
from collections.abc import Callable
from fractions import Fraction

from rich.progress import track

from bench.row import Row, row
from bench.verilator import Verilated
from railgate.engines import Engine, open_engine
from railgate.engines.run import run as run_through
from railgate.odometer.design import design
from railgate.odometer.measure import stimulus
from railgate.odometer.plant import Sensor, constant, shuttle
from railgate.odometer.plant import run as metro
from railgate.odometer.spec import Config
from railgate.waves import Trace

ROUNDS = 5
EVERY_S = Fraction(1, 50)


def run() -> list[Row]:
    return [*_speed(), *_equality()]


def _speed() -> list[Row]:
    """10 s at 200 km/h, 16 MHz: every engine in turn, five rounds, outputs hashed."""
    config = Config(sensors=1)
    inputs = stimulus(Sensor().drive(constant(200, 10), config), config, EVERY_S)
    odometer = design(config)
    engines: dict[str, Callable[[], Engine]] = {
        "leap": lambda: open_engine(odometer, "leap"),
        "cxxrtl": lambda: open_engine(odometer, "cxxrtl"),
        "verilator": lambda: Verilated(odometer),
    }
    digests = {name: _digest(make().advance(inputs.end, inputs)) for name, make in engines.items()}
    if len(set(digests.values())) != 1:
        raise AssertionError(f"the engines' outputs must be equal, not {digests}")
    seconds: dict[str, list[float]] = {name: [] for name in engines}
    for _ in track(range(ROUNDS), "leap against the simulators", transient=True):
        for name, make in engines.items():
            repeats = 21 if name == "leap" else 1
            seconds[name].append(statistics.median(_timed(make(), inputs) for _ in range(repeats)))
    slow = [min(pair) for pair in zip(seconds["cxxrtl"], seconds["verilator"], strict=True)]
    ratio = statistics.median(s / f for s, f in zip(slow, seconds["leap"], strict=True))
    edges = len(inputs["sensor.0.a"]) + len(inputs["sensor.0.b"])
    leap_s = statistics.median(seconds["leap"])
    rows = [row("leap / faster simulator, 10 s at 200 km/h", ratio, "×", least=5000)]
    rows += [
        row(f"{name}, 10 s at 200 km/h", inputs.end / statistics.median(seconds[name]), "ticks/s")
        for name in engines
    ]
    return [*rows, row("leap, per edge", leap_s / edges * 1e9, "ns")]


def _timed(engine: Engine, inputs: Trace) -> float:
    begin = time.perf_counter()
    engine.advance(inputs.end, inputs)
    return time.perf_counter() - begin


def _digest(trace: Trace) -> str:
    digest = hashlib.sha256(f"{trace.period} {trace.start} {trace.end}".encode())
    for name in sorted(trace.signals):
        wave = trace[name]
        digest.update(f"{name} {wave.width} {wave.signed}".encode())
        digest.update(wave.ticks.tobytes())
        digest.update(wave.values.tobytes())
    return digest.hexdigest()


def _equality() -> list[Row]:
    """Mixed stimulus, faults of every kind: leap and the gateware, compared tick for tick."""
    total, differences = 0, 0
    rough = {"tooth_error": 0.05, "jitter_s": 2e-6, "dropouts": 1e-3, "glitches_hz": 300.0}
    runs = [
        (metro(200, 16), Sensor(**rough, seed=1), 0),
        (shuttle(40, 16), Sensor(**rough, glitch_s=5e-6, seed=2), 100),
        (constant(-215, 16), Sensor(duty=0.45, phase_deg=75, tooth_error=0.02, seed=3), 16),
        (shuttle(3, 16), Sensor(**rough, glitch_s=4e-4, b_dead_s=12.0, seed=4), 1000),
    ]
    for profile, sensor, filter_ticks in track(runs, "leap ≡ cxxrtl", transient=True):
        config = Config(sensors=1, filter_ticks=filter_ticks, stamp_depth=8)
        inputs = stimulus(sensor.drive(profile, config), config, Fraction(17, 1000))
        leap = run_through(open_engine(design(config), "leap"), inputs)
        gateware = run_through(open_engine(design(config), "cxxrtl"), inputs)
        differences += leap.first_difference(gateware) is not None
        total += inputs.end
    return [
        row("leap ≡ cxxrtl, mixed stimulus", float(total), "ticks", least=1e9),
        row("leap ≡ cxxrtl, runs that differ", float(differences), "runs", most=0),
    ]
