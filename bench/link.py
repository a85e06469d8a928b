"""The link's model against the faster of two RTL simulators, their equality, and the bit clock."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection
from dataclasses import replace
from fractions import Fraction
from statistics import median

import numpy as np
from rich.progress import track

from bench.row import Row, row
from bench.verilator import Verilated
from railgate.engines import Engine, open_engine
from railgate.position_link.design import design
from railgate.position_link.plant import FAULTS, Fault, Scenario, drive
from railgate.position_link.spec import CRC16, Check, Config, Edge
from railgate.waves import Trace, Waveform

__all__ = ["run"]

ROUNDS = 5
REPEATS = 3
"""Runs of the model in a round, since one takes so little time."""
HOUR = 180_000
"""Cycles of the speed's stimulus."""
PIECE = 50
"""Of these, what the simulators run."""
CLOCKED = 500
"""What the model runs where CLK is asked for."""

CLOCKS_MHZ = (40, 48, 50, 100, 125)
RATE_S = 1


def run() -> list[Row]:
    """Rows of name, value, unit, goal, met. Raises AssertionError where two engines disagree."""
    return [*_speed(), *_equality(), *(each for mhz in CLOCKS_MHZ for each in _rate(mhz))]


def _faults(seconds: int) -> tuple[Fault, ...]:
    """Of each kind one after the other, in the middle of every second."""
    found = []
    for second in range(seconds):
        turn, at = divmod(second, len(FAULTS))
        kind = list(FAULTS)[at]
        # The delay grows and shrinks in turn, so that it stays what a cable may have.
        value = 5 * (-1) ** turn if kind == "drift" else None
        found.append(Fault(kind, second + Fraction(1, 2), value=value))
    return tuple(found)


def _speed() -> list[Row]:
    """One hour at 40 MHz with 3600 faults: every engine in turn, five rounds, outputs compared."""
    config = Config()
    link = design(config)
    inputs = drive(Scenario(faults=_faults(int(HOUR * config.cycle_s))), config, HOUR)
    names = list(open_engine(link, "leap").advance(0, inputs).signals)
    quiet = [name for name in names if name not in ("clk", "anf")]
    engines: dict[str, Callable[[], Engine]] = {
        "leap": lambda: open_engine(link, "leap"),
        "cxxrtl": lambda: open_engine(link, "cxxrtl"),
        "Verilator": lambda: Verilated(link),
    }
    rows = []
    for told, leaps, what in (
        (quiet, HOUR, "1 h without clk and anf"),
        (names, CLOCKED, "10 s with clk and anf"),
    ):
        rates = _rates(engines, inputs, config, leaps, told, what)
        goal = 5_000 if told is quiet else None
        rows.append(row(f"link: leap / faster simulator, {what}", _ratio(rates), "×", least=goal))
        rows += [row(f"link: {name}, {what}", median(r), "ticks/s") for name, r in rates.items()]
    return rows


def _rates(
    engines: dict[str, Callable[[], Engine]],
    inputs: Trace,
    config: Config,
    leaps: int,
    outputs: Collection[str],
    what: str,
) -> dict[str, list[float]]:
    """Simulated ticks per second, of each engine one figure a round."""
    cycles = dict.fromkeys(engines, PIECE) | {"leap": leaps}
    ends = {name: 1 + n * config.cycle_ticks for name, n in cycles.items()}
    rates: dict[str, list[float]] = {name: [] for name in engines}
    for make in engines.values():  # built, loaded and compiled before any time counts
        make().advance(ends["cxxrtl"], inputs, outputs)
    for _ in track(range(ROUNDS), f"link, {what}", transient=True):
        pieces = []
        for name, make in engines.items():
            seconds = []
            for _ in range(REPEATS if name == "leap" else 1):
                spent, found = _timed(make(), ends[name], inputs, outputs)
                seconds.append(spent)
            rates[name].append(ends[name] / median(seconds))
            pieces.append(found.slice(0, ends["cxxrtl"]))
        for piece in pieces[1:]:
            assert pieces[0] == piece, pieces[0].first_difference(piece)
    return rates


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


CONFIGS = (
    Config(),
    Config(sampling_edge=Edge.RISING, check=CRC16, zero_is_fault=True, timeout_from_end=True),
    Config(
        clock_hz=125_000_000,
        word_bits=130,
        check=Check(width=5, polynomial=0x15),
        filter_ticks=40,
        guard_ticks=20,
        tolerated_cycles=2,
        recovery_cycles=3,
        earliest_clk=6,
    ),
    Config(bit_rate_hz=Fraction(511_950), word_bits=8, bare=True, filter_ticks=0, guard_ticks=0),
)
EQUAL_TICKS = 260_000_000
"""Of each of CONFIGS."""
PART = 20
"""Cycles that are compared at once."""


def _equality() -> list[Row]:
    """Two faults in five cycles, every output, CLK too: leap and the gateware, tick for tick."""
    total = differences = 0
    for seed, config in enumerate(track(CONFIGS, "link, leap ≡ cxxrtl", transient=True)):
        cycles = -(-EQUAL_TICKS // config.cycle_ticks)
        inputs = drive(_random_scenario(config, cycles, seed), config, cycles)
        engines = [open_engine(design(config), kind) for kind in ("leap", "cxxrtl")]
        differs = False
        for end in range(PART * config.cycle_ticks, inputs.end, PART * config.cycle_ticks):
            leap, gateware = (engine.advance(end, inputs) for engine in engines)
            differs |= leap.first_difference(gateware) is not None
        differences += differs
        total += engines[0].now
    return [
        row("link: leap ≡ cxxrtl, all outputs, with faults", float(total), "ticks", least=1e9),
        row("link: leap ≡ cxxrtl, runs that differ", float(differences), "runs", most=0),
    ]


def _random_scenario(config: Config, cycles: int, seed: int) -> Scenario:
    random = np.random.default_rng(seed)
    kinds = random.choice([kind for kind in FAULTS if kind != "drift"], 2 * cycles // 5)
    starts = random.random(kinds.size) * float(cycles * config.cycle_s)
    faults = [
        Fault(str(kind), Fraction(float(start))) for kind, start in zip(kinds, starts, strict=True)
    ]
    drift = Fault("drift", Fraction(0), cycles * config.cycle_s, 200)
    return Scenario(faults=(*faults, drift), seed=seed)


def _rate(clock_mhz: int) -> list[Row]:
    """The bit clock of the gateware over RATE_S, and that of a divider by a whole number."""
    config = replace(Config(), clock_hz=clock_mhz * 1_000_000)
    whole = round(config.clock_hz / config.bit_rate_hz)
    ours, theirs = f"{clock_mhz} MHz: our divider", f"{clock_mhz} MHz: plain division by {whole}"
    plain = Fraction(whole * config.cycle_bits, config.clock_hz)
    return [
        *_measured(ours, config),
        row(f"{theirs}, CLK", config.clock_hz / whole / 1e3, "kHz"),
        row(f"{theirs}, cycle", float(plain) * 1e3, "ms"),
        row(f"{theirs}, drift in an hour", float((plain / config.cycle_s - 1) * 3600), "s"),
    ]


def _measured(ours: str, config: Config) -> list[Row]:
    engine = open_engine(design(config), "cxxrtl")
    end = 2 + RATE_S * config.clock_hz  # the edge that ends the time is in the last tick
    idle = Trace({"uef": Waveform.of([0], [0])}, Fraction(1, config.clock_hz), 0, end)
    found = engine.advance(end, idle, ["clk", "delivery"])
    edges, rising = found["clk"].ticks[1:], found["clk"].rising()
    cycles = np.unique(np.diff(found["delivery"].rising()))
    assert cycles.size == 1, f"each cycle must last as long as any other, not {cycles} ticks"
    # From the ideal instant 1 + n · ticks / (2 · bits) of edge n, times 2 · bits.
    off = 2 * config.bits * (edges - 1) - config.ticks * np.arange(edges.size)
    worst = float(np.abs(off).max()) / (2 * config.bits)
    took = Fraction(int(rising[-1] - rising[0]), config.clock_hz)
    rate = (rising.size - 1) / took
    drift = abs(config.bit_rate_hz / rate - 1) * 3600
    return [
        row(f"{ours}, CLK counted in {float(took):g} s", rising.size - 1, "periods"),
        row(f"{ours}, CLK", float(rate) / 1e3, "kHz"),
        row(f"{ours}, cycle", int(cycles[0]), "ticks"),
        row(f"{ours}, cycle", int(cycles[0]) / config.clock_hz * 1e3, "ms"),
        row(f"{ours}, worst edge off its ideal instant", worst, "ticks", most=1),
        row(f"{ours}, worst edge off its ideal instant", worst / config.clock_hz * 1e9, "ns"),
        row(f"{ours}, drift in an hour", float(drift), "s", most=0),
    ]
