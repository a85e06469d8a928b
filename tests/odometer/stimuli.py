"""What drives an odometer in the tests: configurations small enough to wrap, and their pins."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from hypothesis import strategies as st

from railgate.engines import Engine
from railgate.odometer.spec import Config
from railgate.waves import Trace, Waveform

SMALL: dict[str, Any] = {
    "clock_hz": 20_000,
    "sensors": 1,
    "overspeed_kmh": Fraction(50),
    "count_bits": 8,
    "time_bits": 16,
    "period_bits": 9,
}
"""A configuration whose periods last from 14 to 246 ticks."""


@dataclass
class Pins:
    """The levels of a and b as they are driven, with the tick of each change."""

    tick: int = 0
    level: int = 0
    changes: list[tuple[int, int]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.changes.append((0, self.level))

    def toggle(self, gap: int, channels: int) -> None:
        """After `gap` ticks a changes (channels 1), b (2) or both (3)."""
        self.tick += gap
        self.level ^= channels
        self.changes.append((self.tick, self.level))

    def step(self, gap: int, forward: bool) -> None:
        """One quarter period on: a changes where it leads and both are equal, and so on."""
        equal = self.level in (0, 3)
        self.toggle(gap, 1 if equal == forward else 2)

    def wave(self, channel: int) -> Waveform:
        ticks, levels = zip(*self.changes, strict=True)
        return Waveform.of(ticks, [level >> channel & 1 for level in levels])


def pulses(gaps: Iterable[tuple[int, int]]) -> Waveform:
    """A wave that is low, then high, for so many ticks, again and again."""
    ticks, tick = [0], 0
    for low, high in gaps:
        ticks += [tick + low, tick + low + high]
        tick = ticks[-1]
    return Waveform.of(ticks, [i % 2 for i in range(len(ticks))])


def trace(config: Config, signals: dict[str, Waveform], end: int) -> Trace:
    """A stimulus over 0 ≤ tick < end; all that is not named is low."""
    names = ["strobe", "rst"]
    for i in range(config.sensors):
        names += [f"sensor.{i}.a", f"sensor.{i}.b"]
        names += [f"sensor.{i}.stamps.ready"] if config.stamp_depth else []
    low = Waveform.of([0], [0])
    cut = {name: signals.get(name, low).slice(0, end) for name in names}
    return Trace(cut, Fraction(1, config.clock_hz), 0, end)


@st.composite
def configs(draw: st.DrawFn, stamp_depths: tuple[int, ...] = (0, 1, 3, 16)) -> Config:
    """Small ones: counters wrap, periods saturate and windows overflow within a few hundred ticks.

    A period at overspeed is 14 or 49 ticks, at minimum speed 123 or 246.
    """
    overspeed = draw(st.sampled_from((50, 15)))
    return Config(
        clock_hz=20_000,
        sensors=draw(st.integers(1, 2)),
        filter_ticks=draw(st.integers(0, 5 if overspeed == 50 else 20)),
        overspeed_kmh=Fraction(overspeed),
        minimum_kmh=Fraction(draw(st.sampled_from((3, 6)))),
        phase_fault_periods=draw(st.integers(1, 4)),
        missing_pulses=draw(st.integers(2, 4)),
        period_bits=draw(st.integers(8, 10)),
        count_bits=8,
        time_bits=16,
        window_pulses=draw(st.integers(1, 12)),
        stamp_depth=draw(st.sampled_from(stamp_depths)),
    )


def pieces(model: Engine, stimulus: Trace, cuts: Iterable[int]) -> Trace:
    """The outputs from now on, run in pieces that end at `cuts`."""
    ends = [*sorted(cut for cut in cuts if model.now <= cut <= stimulus.end), stimulus.end]
    parts = [model.advance(end, stimulus) for end in ends]
    whole = parts[0]
    for part in parts[1:]:
        whole = whole.concatenate(part)
    return whole


GAPS = st.one_of(st.integers(1, 8), st.integers(1, 30), st.integers(20, 80))
REGULAR = st.tuples(st.booleans(), st.tuples(GAPS, GAPS, GAPS, GAPS), st.integers(1, 30))
EVEN = st.builds(lambda way, gap, n: (way, (gap,) * 4, n), st.booleans(), GAPS, st.integers(1, 50))
BOUNCE = st.lists(st.tuples(st.integers(1, 25), st.sampled_from((1, 1, 2, 2, 3))), max_size=20)
PAUSE = st.builds(lambda ticks: [(ticks, 1)], st.integers(1, 1200))


@st.composite
def sensor_pins(draw: st.DrawFn) -> Pins:
    """Runs of quadrature either way, at any speed, between bounce, double edges and standstill."""
    pins = Pins(level=draw(st.integers(0, 3)))
    for piece in draw(st.lists(st.one_of(EVEN, REGULAR, BOUNCE, PAUSE), max_size=6)):
        if isinstance(piece, list):
            for gap, channels in piece:
                pins.toggle(gap, channels)
        else:
            forward, gaps, steps = piece
            for step in range(steps):
                pins.step(gaps[step % 4], forward)
    return pins


STROBES = st.lists(
    st.tuples(st.one_of(st.integers(1, 40), st.integers(1, 400)), st.integers(1, 40)), max_size=25
)
READIES = st.lists(st.tuples(st.integers(1, 60), st.integers(1, 60)), max_size=25)
RESETS = st.one_of(
    st.just([]), st.lists(st.tuples(st.integers(1, 900), st.integers(1, 5)), max_size=3)
)


@st.composite
def stimuli(
    draw: st.DrawFn, of: st.SearchStrategy[Config] | None = None, end: int = 2500
) -> tuple[Config, Trace]:
    """A configuration and a stimulus for it, of at most `end` ticks from tick 0 on."""
    config = draw(configs() if of is None else of)
    signals = {"strobe": pulses(draw(STROBES)), "rst": pulses(draw(RESETS))}
    last = 60
    for i in range(config.sensors):
        pins = draw(sensor_pins())
        last = max(last, pins.tick + 60)
        signals |= {f"sensor.{i}.a": pins.wave(0), f"sensor.{i}.b": pins.wave(1)}
        if config.stamp_depth:
            signals[f"sensor.{i}.stamps.ready"] = pulses(draw(READIES))
    return config, trace(config, signals, min(last, end))
