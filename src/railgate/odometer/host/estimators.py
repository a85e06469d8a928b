"""A snapshot's wheel speed with its guaranteed interval: one period, Π, Ω, and at the strobe.

Speeds are magnitudes. A *pace* is a time over a way, ticks per pitch. An edge at the true instant t
(in ticks, behind the input's constant delay) is stamped s = ceil(t), so that t lies in (s - 1, s];
all intervals here follow from that and from the Assumptions. Requirements ODO-3, ODO-10, ODO-11,
ODO-14.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from railgate.odometer.host.readout import Snapshot
from railgate.odometer.spec import Assumptions, Config

__all__ = [
    "Estimate",
    "Scale",
    "least_squares",
    "mean_paces",
    "mean_speed",
    "one_period",
    "present",
    "reciprocal",
    "weighted_paces",
]

OUTWARD = 2.0**-44
"""Relative widening of every interval: more than the roundings of the few operations behind it."""


@dataclass(frozen=True)
class Estimate:
    """A speed, km/h. value_kmh: the best single figure, None where none was measured.

    low_kmh, high_kmh: guaranteed to hold the quantity named by `of`, as long as all of `rests_on`
    holds; high_kmh is inf where nothing bounds it. std_kmh: standard deviation of the value from
    the tick alone, None where there is none. flags: what the host found odd, in lower case.
    """

    value_kmh: float | None
    low_kmh: float
    high_kmh: float
    std_kmh: float | None
    of: str
    rests_on: tuple[str, ...]
    flags: tuple[str, ...] = ()


@dataclass(frozen=True)
class Scale:
    """From ticks and pitches to km/h and m/s², with the tolerances of both (ODO-14).

    unit_kmh: km/h at a pace of 1 tick per pitch. low, high: factors on a nominal speed. tick_min_s,
    tick_max_s: seconds. pitch_max_m: metres. acceleration: the greatest in pitches per tick², jerk:
    in pitches per tick³, either however the clock and the wheel err.
    """

    config: Config
    assumptions: Assumptions
    unit_kmh: float = field(init=False)
    low: float = field(init=False)
    high: float = field(init=False)
    tick_min_s: float = field(init=False)
    tick_max_s: float = field(init=False)
    pitch_max_m: float = field(init=False)
    acceleration: float = field(init=False)
    jerk: float = field(init=False)

    def __post_init__(self) -> None:
        config, assumed = self.config, self.assumptions
        ppm = assumed.crystal_ppm * 1e-6
        wheel = assumed.diameter_tolerance_m / float(config.wheel_diameter_m)
        if wheel >= 1:
            raise ValueError(
                f"diameter_tolerance_m must be below the diameter, "
                f"{float(config.wheel_diameter_m):g}, not {assumed.diameter_tolerance_m}"
            )
        slowest_hz, pitch_min_m = config.clock_hz * (1 - ppm), config.pitch_m * (1 - wheel)
        for name, value in (
            ("unit_kmh", 3.6 * config.pitch_m * config.clock_hz),
            ("low", (1 - ppm) * (1 - wheel) * (1 - OUTWARD)),
            ("high", (1 + ppm) * (1 + wheel) * (1 + OUTWARD)),
            ("tick_min_s", 1 / (config.clock_hz * (1 + ppm))),
            ("tick_max_s", 1 / slowest_hz),
            ("pitch_max_m", config.pitch_m * (1 + wheel)),
            ("acceleration", assumed.acceleration_max / (pitch_min_m * slowest_hz**2)),
            ("jerk", assumed.jerk_max / (pitch_min_m * slowest_hz**3)),
        ):
            object.__setattr__(self, name, value)

    def interval(self, pace_low: float, pace_high: float) -> tuple[float, float]:
        """The guaranteed speeds, km/h, of nominal paces, ticks per pitch; a pace may be inf."""
        return self.unit_kmh / pace_high * self.low, self.unit_kmh / pace_low * self.high

    def premises(self, *further: str) -> tuple[str, ...]:
        """What an interval rests on, in words."""
        assumed = self.assumptions
        words = [
            "no edge lost or false, each stamped less than 1 tick late",
            "no reversal between them",
        ]
        words.append(f"clock within ±{assumed.crystal_ppm:g} ppm")
        words.append(f"wheel diameter within ±{1e3 * assumed.diameter_tolerance_m:g} mm")
        words.append(f"rising edges of a within ±{assumed.tooth_error:g} pitch of their places")
        return (*words, *further)

    @property
    def premise_acceleration(self) -> str:
        return f"acceleration within ±{self.assumptions.acceleration_max:g} m/s²"


def mean_paces(n: int, ticks: int, tooth: float) -> tuple[float, float]:
    """The mean pace between two edges n pitches ± 2·tooth apart, stamped `ticks` apart.

    Each stamp is late by less than a tick, so the time is in (ticks - 1, ticks + 1) (ODO-3).
    """
    return (ticks - 1) / (n + 2 * tooth), (ticks + 1) / (n - 2 * tooth)


def weighted_paces(
    n: int, ticks: int, pace: float, tooth: float, acceleration: float
) -> tuple[float, float]:
    """The parabola-weighted mean pace of n periods, whose least-squares pace (Ω) is `pace`.

    Ω = Σ w_k s_k, w_k = 12(k - n/2) / (n(n+1)(n+2)), k = 0 … n. Σ w_k = 0, and summed by parts Ω is
    Σ W_j (s_j - s_{j-1}) with W_j = 6 j(n+1-j) / (n(n+1)(n+2)) ≥ 0, ΣW_j = 1: the mean of the
    periods under a parabola. It is off by Σ w_k ε_k, ε_k in [0, 1) the stamps' lateness; about the
    middle, ε_k - ½, that is less than ½Σ|w_k|: 3 / (2(n+1)) ticks where n is even,
    3(n+1) / (2n(n+2)) where it is odd.

    With tooth error, edge k is met at most tooth · (greatest pace nearby) beside the instant of its
    place, which adds Σ|w_k| · tooth · that pace. The greatest pace rests on `acceleration`, pitches
    per tick²: somewhere between the edges the speed v is the mean one, and v² changes by at most
    2 · acceleration · way, the way being less than n + 4·tooth pitches. Where that leaves no speed
    at all the pace is unbounded, inf. The mean of the periods itself also lies within these paces.
    """
    half = 3 * (n + 1) / (2 * n * (n + 2)) if n % 2 else 3 / (2 * (n + 1))
    if tooth == 0.0:
        return pace - half, pace + half
    fast, slow = mean_paces(n, ticks, tooth)
    change = 2 * acceleration * (n + 4 * tooth)
    pace_min = 1 / math.sqrt(1 / fast**2 + change)
    if 1 / slow**2 <= change:
        return pace_min, math.inf
    pace_max = 1 / math.sqrt(1 / slow**2 - change)
    reach = half + 2 * half * tooth * pace_max
    return max(pace - reach, pace_min), min(pace + reach, pace_max)


def mean_speed(n: int, ticks: int, scale: Scale) -> Estimate:
    """The mean speed between two rising edges of a, n ≥ 1 pitches and `ticks` > 1 apart (Π).

    Each stamp's lateness is even over a tick: the variance of their difference is 1/6 tick².
    """
    value = scale.unit_kmh * n / ticks
    interval = scale.interval(*mean_paces(n, ticks, scale.assumptions.tooth_error))
    of = "mean speed between the first and the last rising edge of a"
    return Estimate(value, *interval, value / math.sqrt(6) / ticks, of, scale.premises())


def one_period(snapshot: Snapshot, scale: Scale) -> Estimate:
    """The speed of the last period, as the source has it; `present` where it is not valid.

    It may have ended before the last snapshot: whether it did, `pulses` says. Ref: section 2.2.
    """
    if not snapshot.period_valid:
        return present(snapshot, scale)
    return mean_speed(1, snapshot.period, scale)


def reciprocal(snapshot: Snapshot, scale: Scale) -> Estimate:
    """Π: the mean speed over the window's periods; `present` where it has none (ODO-10)."""
    if not snapshot.window_n:
        return present(snapshot, scale)
    return mean_speed(snapshot.window_n, snapshot.window_ticks, scale)


def least_squares(snapshot: Snapshot, scale: Scale) -> Estimate:
    """Ω: the least-squares period over the window; `present` where it has none (ODO-10).

    6[(n+2)A - 2B] / (n(n+1)(n+2)), in integers up to the one division. Its variance is
    12σ² / (N(N²-1)), N = n + 1 edges, σ² = 1/12 tick² of each stamp.
    """
    n = snapshot.window_n
    if not n:
        return present(snapshot, scale)
    pace = 6 * ((n + 2) * snapshot.sum_a - 2 * snapshot.sum_b) / (n * (n + 1) * (n + 2))
    tooth = scale.assumptions.tooth_error
    paces = weighted_paces(n, snapshot.window_ticks, pace, tooth, scale.acceleration)
    value = scale.unit_kmh / pace
    std = value / pace / math.sqrt((n + 1) * ((n + 1) ** 2 - 1))
    of = "pitch over the parabola-weighted mean of the window's periods"
    rests_on = scale.premises(*([scale.premise_acceleration] if tooth else []))
    return Estimate(value, *scale.interval(*paces), std, of, rests_on)


def _trailing_kmh(snapshot: Snapshot, scale: Scale) -> float:
    """The greatest speed now that the time since the last rising edge of a leaves (ODO-11).

    In a time u without a rise the wheel went less than L = pitch · (1 + 2·tooth) in one direction.
    At speed V now, it went at least V·u - a·u²/2 that way in the last u ≤ V/a. So V < L/u + a·u/2;
    best at u = √(2L/a), where it is √(2·L·a), and also true of u > V/a up to there. Since reset
    there may have been edges that nobody saw in the input's delay: that is taken off the time.
    """
    delay = scale.config.input_delay_ticks
    a = scale.assumptions.acceleration_max
    way = scale.pitch_max_m * (1 + 2 * scale.assumptions.tooth_error)
    quiet_s = max(snapshot.since_rise - delay - 1, 0) * scale.tick_min_s
    if not quiet_s:
        return math.inf
    best_s = min(quiet_s, math.sqrt(2 * way / a))
    late = a * delay * scale.tick_max_s
    return 3.6 * (way / best_s + a * best_s / 2 + late) * (1 + OUTWARD)


def present(snapshot: Snapshot, scale: Scale) -> Estimate:
    """The wheel's speed in the strobe's tick: an interval, never a value.

    The speed was the mean one somewhere between the two edges of a period or window, and has since
    changed by at most a_max times the time since the first of them. Whatever the edges say, the
    time since the last of them bounds it from above. low_kmh is 0 and high_kmh inf where neither
    says anything: before the first edges, and right after one that ends nothing. Where the bounds
    contradict one another the wheel changed its speed faster: flagged `infeasible`, and the
    interval spans what lies between them.
    """
    low, high = 0.0, _trailing_kmh(snapshot, scale)
    spans = [(1, snapshot.period)] if snapshot.period_valid else []
    if snapshot.window_n:
        spans.append((snapshot.window_n, snapshot.window_ticks))
    if snapshot.since_rise >= scale.config.period_max:
        spans = []
    for n, ticks in spans:
        ago = ticks + snapshot.since_rise + 1 + scale.config.input_delay_ticks
        change = 3.6 * scale.assumptions.acceleration_max * ago * scale.tick_max_s * (1 + OUTWARD)
        mean = mean_speed(n, ticks, scale)
        low, high = max(low, mean.low_kmh - change), min(high, mean.high_kmh + change)
    flags = ("infeasible",) if low > high else ()
    low, high = min(low, high), max(low, high)
    of, rests_on = "wheel speed at the strobe", scale.premises(scale.premise_acceleration)
    return Estimate(None, low, high, None, of, rests_on, flags)
