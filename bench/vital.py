"""The vital output's model against the faster of two RTL simulators, and their equality."""

from __future__ import annotations

import resource
import time
from collections.abc import Callable, Collection
from fractions import Fraction
from statistics import median
from typing import Any

import numpy as np
from rich.progress import track

from bench.row import Row, row
from bench.verilator import Verilated
from railgate.engines import Engine, open_engine
from railgate.vital_output.loop import loop
from railgate.vital_output.plant import FAULTS, Command, Fault, RelayTimes, Scenario
from railgate.vital_output.spec import Config
from railgate.waves import Trace

__all__ = ["run"]

ROUNDS = 5
HOUR = 3_600
PIECE_S = Fraction(1, 50)
"""Of the hour, what the simulators run."""
QUIET = ("pulses", "link_tx")
"""Asked for in no speed: an hour of them has a billion edges."""

MILLI = Fraction(1, 1000)
SCALED = Config(
    clock_hz=1_000_000,
    outputs=3,
    cycle_s=12 * MILLI,
    margin_s=3 * MILLI / 10,
    slew_ticks=20,
    holdover_cycles=20,
    tau0_s=6 * MILLI,
    tau1_s=13 * MILLI / 2,
    bit_ticks=4,
    link_filter_ticks=0,
    line_ticks=4,
    spare_messages=0,
    lost_messages=2,
    window_messages=32,
    drift_limit_ppm=400,
    pulse_hz=5_000,
    feedback_filter_ticks=2,
    contact_filter_ticks=5,
    pick_up_s=1 * MILLI,
    release_s=9 * MILLI,
    release_min_s=6 * MILLI,
)
"""Every window keeps its order, but a cycle has 12 000 ticks: so 10⁹ ticks see 40 000 cycles."""
SCALED_RELAY = RelayTimes(clock_hz=100_000, pick_up_s=MILLI * 8 / 10, release_s=8 * MILLI)
EQUAL_TICKS = 1_000_000_000
RUN_CYCLES = 100
"""Of each mixed scenario whose traces are compared."""


def run() -> list[Row]:
    """Rows of name, value, unit, goal, met. Raises AssertionError where two engines disagree."""
    return [*_speed(), *_equality()]


def _hour() -> Scenario:
    """An hour in which output 0 is on for 3 s in 10, three more for 30 s in each minute, with a
    fault a minute."""
    kinds = [kind for kind in FAULTS if not kind.startswith(("stopped", "time-drift"))]
    faults = tuple(
        Fault(
            kinds[minute % len(kinds)],
            Fraction(60 * minute + 20),
            Fraction(60 * minute + 20) + Fraction(1, 5),
        )
        for minute in range(HOUR // 60)
    )
    times = sorted({t for m in range(0, HOUR, 60) for t in range(m, m + 60) if t and t % 5 == 0})
    commands = tuple(
        Command(
            start_s=Fraction(t),
            image=int(t % 10 == 5) | (0b1110 if t % 60 < 30 else 0),
            acknowledge=0xFFFF * (t // 5 % 2),
        )
        for t in times
    )
    return Scenario(
        commands=commands,
        seconds=Fraction(HOUR),
        faults=faults,
        ppm_1=Fraction(60),
        ppm_2=Fraction(-40),
    )


def _speed() -> list[Row]:
    """Both channels, cross-link and relays in a closed loop: every engine in turn, outputs
    compared."""
    config, scenario = Config(), _hour()
    pair = loop(config, scenario.relay, scenario.clocks(config))
    inputs = scenario.controls(config)
    piece = int(PIECE_S / inputs.period)
    engines: dict[str, Callable[[], Engine]] = {
        "leap": lambda: open_engine(pair, "leap"),
        "cxxrtl": lambda: open_engine(pair, "cxxrtl"),
        "Verilator": lambda: Verilated(pair),
    }
    names = list(open_engine(pair, "leap").advance(0, inputs).signals)
    told = [name for name in names if not name.endswith(QUIET)]
    builds = {}
    for name, make in engines.items():  # built, loaded and compiled before any time counts
        begin = time.perf_counter()
        make().advance(piece // 100, inputs, told)
        builds[name] = time.perf_counter() - begin
    ends = dict.fromkeys(engines, piece) | {"leap": inputs.end}
    rates: dict[str, list[float]] = {name: [] for name in engines}
    for _ in track(range(ROUNDS), "vital output, speed", transient=True):
        pieces = []
        for name, make in engines.items():
            seconds, found = _timed(make(), ends[name], inputs, told)
            rates[name].append(float(ends[name] * inputs.period) / seconds)
            pieces.append(found.slice(0, piece))
        for other in pieces[1:]:
            assert pieces[0] == other, pieces[0].first_difference(other)
    simulators = zip(rates["cxxrtl"], rates["Verilator"], strict=True)
    ratios = [leap / max(two) for leap, two in zip(rates["leap"], simulators, strict=True)]
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    what = "vital output, closed loop"
    return [
        row(f"{what}: leap / faster simulator", median(ratios), "×", least=1_000),
        *(row(f"{what}: {name}", median(r), "× real time") for name, r in rates.items()),
        *(row(f"{what}: {name}, build or load", s, "s") for name, s in builds.items()),
        row(f"{what}: peak memory of the process", memory, "GiB", most=2),
    ]


def _timed(
    engine: Engine, until: int, inputs: Trace, outputs: Collection[str]
) -> tuple[float, Trace]:
    begin = time.perf_counter()
    found = engine.advance(until, inputs, outputs)
    return time.perf_counter() - begin, found


def _mixed(seed: int, ppm: tuple[Fraction, Fraction]) -> Scenario:
    """Some faults of any kind at any time, output by output on and off at any time."""
    random = np.random.default_rng(seed)
    cycle, seconds = SCALED.cycle_s, RUN_CYCLES * SCALED.cycle_s
    kinds = random.choice(list(FAULTS), 6)
    starts = random.integers(0, RUN_CYCLES * 1000 - 1, kinds.size)
    lengths = random.integers(1, 4000, kinds.size)
    faults = [
        Fault(str(kind), int(start) * cycle / 1000, int(start + length) * cycle / 1000)
        for kind, start, length in zip(kinds, starts, lengths, strict=True)
    ]
    times = np.unique(random.integers(1, RUN_CYCLES, 12))
    commands = tuple(
        Command(
            start_s=int(t) * cycle,
            image=int(random.integers(8)),
            acknowledge=int(random.integers(8)),
        )
        for t in times
    )
    timing: dict[str, Any] = {"ppm_1": ppm[0], "ppm_2": ppm[1], "phase_2": Fraction(1, 3)}
    return Scenario(
        commands=commands,
        seconds=seconds,
        faults=tuple(faults),
        relay=SCALED_RELAY,
        seed=seed,
        **timing,
    )


PPMS = ((Fraction(100), Fraction(-100)), (Fraction(-73), Fraction(900)))


def _equality() -> list[Row]:
    """Every output, pulses and cross-link too: leap and the gateware, tick for tick."""
    ticks_of_run = 2 * RUN_CYCLES * SCALED.cycle_ticks
    runs = -(-EQUAL_TICKS // ticks_of_run)
    built = []
    for ppm in PPMS:
        pair = loop(SCALED, SCALED_RELAY, _mixed(0, ppm).clocks(SCALED))
        engine = open_engine(pair, "cxxrtl")
        built.append((ppm, pair, engine, engine.checkpoint()))
    differences = 0
    for seed in track(range(runs), "vital output, leap ≡ cxxrtl", transient=True):
        ppm, pair, gateware, start = built[seed % len(built)]
        inputs = _mixed(seed, ppm).controls(SCALED)
        gateware.restore(start)
        leap = open_engine(pair, "leap").advance(inputs.end, inputs)
        found = gateware.advance(inputs.end, inputs)
        differences += leap.first_difference(found) is not None
    what = "vital output: leap ≡ cxxrtl, all outputs, with faults"
    return [
        row(what, float(runs * ticks_of_run), "ticks of both FPGAs", least=1e9),
        row(f"{what}, runs that differ", float(differences), "runs", most=0),
    ]
