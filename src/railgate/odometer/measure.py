"""From pins to speed, direction and distance: a capture through an engine, read as a CPU would."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from fractions import Fraction
from typing import Any, TypedDict, Unpack

import numpy as np

from railgate.engines import open_engine
from railgate.engines.run import run
from railgate.odometer.design import design
from railgate.odometer.host import (
    ESTIMATORS,
    Estimate,
    Snapshot,
    Wheel,
    direction,
    distance_m,
    phase_deg,
    snapshots,
    stamps,
)
from railgate.odometer.spec import Assumptions, Config, Flag
from railgate.waves import Trace, Waveform

__all__ = [
    "How",
    "Measurement",
    "Progress",
    "Replay",
    "Window",
    "measure",
    "part",
    "pin_tick",
    "replay",
    "stimulus",
    "tell",
]

STAMP_DEPTH = 16
"""Enough where the reader takes each stamp at once."""
MOST_WINDOWS = 1_000_000
MOST_PULSES = 92_000
"""Periods of one window, as many as leave the Ω sums 64 bits."""

EVERY_S, ENGINE, ESTIMATOR = Fraction(1, 50), "leap", "pi"

Progress = Callable[[float], None]


class How(TypedDict, total=False):
    """How to measure: a snapshot every `every_s`, the engine and estimator by name, what the
    guaranteed interval rests on, and what is called with the part done, 0 … 1."""

    every_s: Fraction
    engine: str
    estimator: str
    assumptions: Assumptions
    progress: Progress | None


@dataclass(frozen=True)
class Window:
    """What one snapshot says.

    t_s: the instant it speaks of, s of the capture. speed_*: magnitude and its guaranteed interval,
    km/h; speed_kmh is None where the window holds no measurement, speed_high_kmh where nothing
    bounds it. direction: forward, reverse or none, by the ×4 position. pulses: rising edges of a,
    in whatever direction. period_ticks, phase_deg: of the last whole period, None before the first
    and where a reversal spoilt it. guarantee: what the interval is guaranteed to hold. flags: what
    the gateware and the host raised, in lower case. true_speed_kmh: in a simulation just that.
    """

    t_s: float
    speed_kmh: float | None
    speed_low_kmh: float
    speed_high_kmh: float | None
    direction: str
    pulses: int
    period_ticks: int | None
    phase_deg: float | None
    guarantee: str
    flags: tuple[str, ...]
    true_speed_kmh: float | None = None

    @property
    def truth_outside(self) -> bool:
        """The true speed is known and not in the guaranteed interval."""
        true, high = self.true_speed_kmh, self.speed_high_kmh
        return true is not None and not self.speed_low_kmh <= true <= (
            math.inf if high is None else high
        )


@dataclass(frozen=True)
class Measurement:
    """A capture's windows and totals.

    distances_m: the way at each window's end. gateware: what the pins held and what came out, in
    ticks of the clock. The rest is told in docs/commands.md.
    """

    engine: str
    clock_hz: int
    duration_s: float
    a_rising: int
    b_rising: int
    position_x4: int
    direction_changes: int
    illegal_transitions: int
    rejected_glitches: int
    distance_m: float
    estimator: str
    guarantee: str
    rests_on: tuple[str, ...]
    windows: tuple[Window, ...]
    distances_m: tuple[float, ...]
    gateware: Trace

    def as_json(self) -> dict[str, Any]:
        """All but the waves, as plain numbers, strings and lists."""
        hidden = ("gateware", "distances_m")
        totals = {name: value for name, value in vars(self).items() if name not in hidden}
        return {**totals, "windows": [asdict(window) for window in self.windows]}

    @property
    def truth_outside(self) -> int | None:
        """In how many windows the true speed leaves its interval; None where it is not known."""
        known = [window for window in self.windows if window.true_speed_kmh is not None]
        return sum(window.truth_outside for window in known) if known else None

    @property
    def truth_outside_flagged(self) -> int:
        """In how many of these windows a flag says that something is wrong."""
        return sum(window.truth_outside and bool(window.flags) for window in self.windows)


def part(pins: Trace, span_s: tuple[Fraction, Fraction]) -> Trace:
    """The ticks that begin in a span of the capture's time. Raises ValueError."""
    start, end = (math.ceil(t / pins.period) for t in span_s)
    if not pins.start <= start < end <= pins.end:
        first, last = float(pins.start * pins.period), float(pins.end * pins.period)
        raise ValueError(
            f"a window must lie inside the capture, {first:g} s..{last:g} s, "
            f"not {float(span_s[0]):g} s..{float(span_s[1]):g} s"
        )
    return pins.slice(start, end)


@dataclass(frozen=True)
class Replay:
    """What came out of an engine: its snapshots, an estimate of each, inputs and outputs."""

    config: Config
    shots: Sequence[Snapshot]
    estimates: Sequence[Estimate]
    gateware: Trace


def stimulus(pins: Trace, config: Config, every_s: Fraction) -> Trace:
    """The odometer's inputs: pins a, b from tick 0 on in its clock, and the strobe.

    The j-th strobe ends the window of the pin changes before j · every_s, whatever the filter's
    delay; the last one ends it with the pins' end, taking up a rest too short for a snapshot. The
    levels are held until its snapshot is out. Raises ValueError.
    """
    period = Fraction(1, config.clock_hz)
    pins = pins.shift(-pins.start).resample(period)
    every, latency = every_s / period, config.snapshot_latency_ticks
    if every < latency:
        raise ValueError(
            f"a window must last at least {latency} ticks, {float(latency * period):g} s, "
            f"not {float(every_s):g} s"
        )
    whole = math.ceil(pins.end / every) - 1
    if whole >= MOST_WINDOWS:
        raise ValueError(f"at most {MOST_WINDOWS} windows can be told, not {whole + 1}")
    up, down = every.numerator, every.denominator
    ends = [-(-j * up // down) for j in range(1, whole + 1)]
    if ends and pins.end - ends[-1] < latency:
        ends.pop()
    strobes = np.array([*ends, pins.end]) + config.input_delay_ticks - 1
    end = int(strobes[-1]) + latency + 1
    ticks = np.concatenate([[0], np.column_stack([strobes, strobes + 1]).ravel()])
    names = {"a": "sensor.0.a", "b": "sensor.0.b"}
    inputs = dict(pins.rename(names).extend(end).signals)
    inputs["strobe"] = Waveform.of(ticks, np.arange(ticks.size) & 1)
    if config.stamp_depth:
        inputs["sensor.0.stamps.ready"] = Waveform.of([0], [1])
    return Trace(inputs, period, 0, end)


def measure(pins: Trace, config: Config, **how: Unpack[How]) -> Measurement:
    """Replay the pins (signals a, b) through an engine and read its snapshots as a CPU would.

    config.sensors must be 1; stamp_depth and window_pulses become what is needed. What the pins'
    own sampling costs is in the interval. Raises ValueError.
    """
    return tell(pins, replay(pins, config, **how), **how)


def replay(
    pins: Trace,
    config: Config,
    every_s: Fraction = EVERY_S,
    engine: str = ENGINE,
    estimator: str = ESTIMATOR,
    assumptions: Assumptions | None = None,
    progress: Progress | None = None,
) -> Replay:
    """The first half of `measure`."""
    config = _fitted(config, every_s, estimator)
    wheel = Wheel(config, sampled(pins, config, assumptions or Assumptions()), estimator)
    inputs = stimulus(pins, config, every_s)
    outputs = run(open_engine(design(config), engine), inputs, progress)
    shots = snapshots(outputs, config)
    edges = stamps(outputs, config) if config.stamp_depth else None
    estimates = [wheel.update(shot, edges) for shot in shots]
    return Replay(config, shots, estimates, inputs.merge(outputs))


def sampled(pins: Trace, config: Config, assumptions: Assumptions) -> Assumptions:
    """The assumptions for pins that were sampled, as a capture is, before the clock samples them.

    An edge in (k - 1, k] samples of r ticks each is stamped at ceil(k·r): less than r + 1 ticks
    late, of a whole r at most r.
    """
    ratio = pins.period * config.clock_hz
    late = ratio + 1 - Fraction(1, ratio.denominator)
    return replace(assumptions, late_ticks=max(float(late), assumptions.late_ticks))


def _fitted(config: Config, every_s: Fraction, estimator: str) -> Config:
    """With stamps where the estimator needs them, and room for a window's periods."""
    periods = math.ceil(every_s * config.clock_hz / config.period_min_ticks) + 2
    return replace(
        config,
        stamp_depth=STAMP_DEPTH if estimator == "feasible" else 0,
        window_pulses=min(max(config.window_pulses, periods), MOST_PULSES),
    )


def tell(pins: Trace, replayed: Replay, **how: Unpack[How]) -> Measurement:
    """The second half of `measure`."""
    config, shots, estimates = replayed.config, replayed.shots, replayed.estimates
    estimator, last = how.get("estimator", ESTIMATOR), shots[-1]
    rests_on = dict.fromkeys(premise for e in estimates for premise in e.rests_on)
    return Measurement(
        engine=how.get("engine", ENGINE),
        clock_hz=config.clock_hz,
        duration_s=float(pins.duration_s),
        a_rising=last.a_rising,
        b_rising=last.b_rising,
        position_x4=last.position,
        direction_changes=last.direction_changes,
        illegal_transitions=last.illegal_transitions,
        rejected_glitches=last.rejected_glitches,
        distance_m=distance_m(last.position, config),
        estimator=estimator,
        guarantee=ESTIMATORS[estimator][1],
        rests_on=tuple(rests_on),
        windows=_windows(shots, estimates, config, pins.start * pins.period),
        distances_m=tuple(distance_m(shot.position, config) for shot in shots),
        gateware=replayed.gateware,
    )


def _windows(
    shots: Sequence[Snapshot], estimates: Sequence[Estimate], config: Config, origin_s: Fraction
) -> tuple[Window, ...]:
    start = replace(shots[0], **dict.fromkeys(vars(shots[0]), 0))
    windows = []
    for older, shot, estimate in zip([start, *shots], shots, estimates, strict=False):
        raised = [flag.name.lower() for flag in Flag if flag in shot.causes and flag.name]
        windows.append(
            Window(
                t_s=float(origin_s + Fraction(pin_tick(shot, config), config.clock_hz)),
                speed_kmh=estimate.value_kmh,
                speed_low_kmh=estimate.low_kmh,
                speed_high_kmh=None if math.isinf(estimate.high_kmh) else estimate.high_kmh,
                direction=direction(older, shot, config).name.lower(),
                pulses=shot.pulses,
                period_ticks=shot.period if shot.period_valid else None,
                phase_deg=phase_deg(shot),
                guarantee=estimate.of,
                flags=tuple(dict.fromkeys((*raised, *estimate.flags))),
            )
        )
    return tuple(windows)


def pin_tick(shot: Snapshot, config: Config) -> int:
    """The tick before which the pins' changes are in the snapshot."""
    return shot.time + 1 - config.input_delay_ticks
