"""The pair's model against the faster of two RTL simulators, and their equality."""

from __future__ import annotations

import resource
import time
from collections.abc import Callable, Collection
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from fractions import Fraction
from statistics import median

import numpy as np
from rich.progress import track

from bench.row import Row, row
from bench.verilator import Verilated
from railgate.engines import Design, Engine, open_engine
from railgate.vital_output.loop import loop
from railgate.vital_output.plant.cpu import Command
from railgate.vital_output.plant.edges import Edges
from railgate.vital_output.plant.faults import FAULTS, Fault
from railgate.vital_output.plant.relay import RelayTimes
from railgate.vital_output.plant.scenario import Scenario
from railgate.vital_output.situations import ready_s
from railgate.vital_output.spec import Config
from railgate.waves import Trace

__all__ = ["run"]

ROUNDS = 5
HOUR = 72_000
"""Cycles that the model runs."""
PIECE = 2
"""Of these, what the simulators run: what a tick costs them does not depend on what is in it."""
EVERY = 240
"""Cycles from a command on to the next, and from a fault to the next."""
MOST_GIB = 2
WORKERS = 2


def run() -> list[Row]:
    """Rows of name, value, unit, goal, met. Raises AssertionError where two engines disagree."""
    return [*_speed(), *_equality()]


def _scenario(config: Config, cycles: int, every: int, seed: int, relay: RelayTimes) -> Scenario:
    """Commands on and off in turn and faults of all kinds at random, so many cycles apart."""
    random = np.random.default_rng(seed)
    begin, end = ready_s(config), cycles * config.cycle_s
    times = [begin + n * every * config.cycle_s / 2 for n in range(2 * cycles // every)]
    masks = random.integers(1, 1 << config.outputs, len(times)).tolist()
    commands = [
        Command(start_s=t, image=mask if n % 2 else 0, acknowledge=0 if n % 2 else mask)
        for n, (t, mask) in enumerate(zip(times, masks, strict=True))
        if t < end
    ]
    faults = []
    for kind in random.choice(list(FAULTS), cycles // every).tolist():
        start = Fraction(int(random.integers(int(end * 10**6))), 10**6)
        length = Fraction(int(random.integers(1, int(3 * config.cycle_s * 10**6))), 10**6)
        faults.append(Fault(kind, start, start + length))
    ppm = random.integers(-config.tolerance_ppm, config.tolerance_ppm + 1, 2).tolist()
    return Scenario(
        commands=tuple(commands),
        seconds=end,
        ppm_1=Fraction(ppm[0]),
        ppm_2=Fraction(ppm[1]),
        relay=relay,
        faults=tuple(faults),
        seed=seed,
    )


def _ticks(scenario: Scenario, config: Config, end: int) -> int:
    """Of both channels before a femtosecond."""
    return sum(Edges(clock).count(end) for clock in scenario.clocks(config)[:2])


def _speed() -> list[Row]:
    """One hour of the default configuration: every engine in turn, outputs compared."""
    config = Config()
    scenario = _scenario(config, HOUR, EVERY, 0, RelayTimes())
    inputs = scenario.controls(config)
    pair = loop(config, scenario.relay, scenario.clocks(config))
    engines: dict[str, Callable[[], Engine]] = {
        "leap": lambda: open_engine(pair, "leap"),
        "cxxrtl": lambda: open_engine(pair, "cxxrtl"),
        "Verilator": lambda: Verilated(pair),
    }
    piece = inputs.end * PIECE // HOUR
    ends = dict.fromkeys(engines, piece) | {"leap": inputs.end}
    names = open_engine(pair, "leap").advance(0, inputs).signals
    told = [name for name in names if not name.endswith(("pulses", "link_tx"))]
    for make in engines.values():  # built, loaded and compiled before any time counts
        make().advance(piece // PIECE, inputs, told)
    rates: dict[str, list[float]] = {name: [] for name in engines}
    for _ in track(range(ROUNDS), "the pair, 1 h", transient=True):
        found = []
        for name, make in engines.items():
            spent, outputs = _timed(make(), ends[name], inputs, told)
            rates[name].append(_ticks(scenario, config, ends[name]) / spent)
            found.append(outputs.slice(0, piece))
        for other in found[1:]:
            assert found[0] == other, found[0].first_difference(other)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1 << 20)
    what = "vital: 1 h without pulses and link_tx"
    return [
        row(f"{what}, leap / faster simulator", _ratio(rates), "×", least=1_000),
        *(row(f"{what}, {name}", median(r), "ticks/s") for name, r in rates.items()),
        row(f"{what}, memory at most", peak, "GiB", most=MOST_GIB),
    ]


def _timed(
    engine: Engine, until: int, inputs: Trace, outputs: Collection[str]
) -> tuple[float, Trace]:
    begin = time.perf_counter()
    found = engine.advance(until, inputs, outputs)
    return time.perf_counter() - begin, found


def _ratio(rates: dict[str, list[float]]) -> float:
    """The median of the rounds' ratios, so that all felt the same load."""
    simulators = zip(rates["cxxrtl"], rates["Verilator"], strict=True)
    ratios = [leap / max(two) for leap, two in zip(rates["leap"], simulators, strict=True)]
    return median(ratios)


MILLI = Fraction(1, 1000)
SCALED = Config(
    clock_hz=1_000_000,
    outputs=2,
    cycle_s=12 * MILLI,
    margin_s=Fraction(3, 10) * MILLI,
    slew_ticks=20,
    holdover_cycles=20,
    delay_cycles=2,
    tau0_s=6 * MILLI,
    tau1_s=Fraction(13, 2) * MILLI,
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
    pick_up_s=MILLI,
    release_s=9 * MILLI,
    release_min_s=6 * MILLI,
    count_bits=8,
)
OTHER = replace(
    SCALED,
    outputs=5,
    polynomial=0x04C1_1DB7,
    cycle_s=24 * MILLI,
    tau0_s=11 * MILLI,
    tau1_s=12 * MILLI,
    delay_cycles=1,
    life_cycles=2,
    bit_ticks=5,
    link_filter_ticks=1,
    spare_messages=1,
    lost_messages=3,
    feedback_filter_ticks=0,
    release_s=12 * MILLI,
    release_min_s=11 * MILLI,
    error_interval_s=100 * MILLI,
    zero_at_once=True,
)
QUICK = RelayTimes(pick_up_s=Fraction(8, 10) * MILLI, release_s=7 * MILLI)
SLOW = RelayTimes(clock_hz=160_001, pick_up_s=MILLI, release_s=11 * MILLI)


@dataclass(frozen=True)
class Case:
    """A configuration, its relays, how many cycles it is run for, and the run's seed."""

    config: Config
    relay: RelayTimes
    cycles: int
    seed: int


CASES = (
    *(Case(SCALED, QUICK, 8_000, seed) for seed in range(4)),
    *(Case(OTHER, SLOW, 2_600, seed) for seed in range(4, 6)),
    Case(Config(), RelayTimes(), 40, 6),
)
APART = 8
"""Cycles from a fault to the next."""
PART = 50
"""Cycles that are compared at once."""


def _equality() -> list[Row]:
    """Faults of every kind, every output, pulses and cross-link too: leap and the gateware."""
    with ThreadPoolExecutor(WORKERS) as pool:
        runs = track(pool.map(_differs, CASES), "the pair, leap ≡ RTL", len(CASES), transient=True)
        found = list(runs)
    total = sum(ticks for ticks, _ in found)
    differ = sum(differs for _, differs in found)
    return [
        row("vital: leap ≡ Verilator, all outputs, with faults", float(total), "ticks", least=1e9),
        row("vital: leap ≡ Verilator, runs that differ", float(differ), "runs", most=0),
    ]


def _differs(case: Case) -> tuple[int, bool]:
    """Ticks of both channels, and whether the engines differ in any of them."""
    scenario = _scenario(case.config, case.cycles, APART, case.seed, case.relay)
    inputs = scenario.controls(case.config)
    design: Design = loop(case.config, case.relay, scenario.clocks(case.config))
    leap, rtl = open_engine(design, "leap"), Verilated(design)
    differs = False
    step = PART * inputs.end // case.cycles
    for end in (*range(step, inputs.end, step), inputs.end):
        pieces = [engine.advance(end, inputs) for engine in (leap, rtl)]
        differs |= pieces[0].first_difference(pieces[1]) is not None
    return _ticks(scenario, case.config, inputs.end), differs
