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
    "MEAN",
    "MIDDLE",
    "PRESENT",
    "WEIGHTED",
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

MEAN = "mean speed between the first and the last rising edge of a"
WEIGHTED = "pitch over the parabola-weighted mean of the window's periods"
MIDDLE = "speed midway between the first and the last rising edge of a"
PRESENT = "speed at the strobe"

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
        fastest = self.unit_kmh / pace_low * self.high if pace_low > 0 else math.inf
        return self.unit_kmh / pace_high * self.low, fastest

    def premises(self, *further: str) -> tuple[str, ...]:
        """What an interval rests on, in words."""
        assumed = self.assumptions
        late = "1 tick" if assumed.late_ticks == 1 else f"{assumed.late_ticks:g} ticks"
        words = [f"no edge lost or false, each stamped less than {late} late"]
        words.append("no reversal between them")
        words.append(f"clock within ±{assumed.crystal_ppm:g} ppm")
        words.append(f"wheel diameter within ±{1e3 * assumed.diameter_tolerance_m:g} mm")
        words.append(f"rising edges of a within ±{assumed.tooth_error:g} pitch of their places")
        return (*words, *further)

    @property
    def premise_acceleration(self) -> str:
        return f"acceleration within ±{self.assumptions.acceleration_max:g} m/s²"


def mean_paces(n: int, ticks: int, tooth: float, late: float = 1.0) -> tuple[float, float]:
    """The mean pace between two edges n pitches ± 2·tooth apart, stamped `ticks` apart.

    Each stamp is less than `late` ticks behind its edge, so the time is in (ticks - late,
    ticks + late) (ODO-3).
    """
    return max(ticks - late, 0.0) / (n + 2 * tooth), (ticks + late) / (n - 2 * tooth)


def weighted_paces(
    n: int, ticks: int, pace: float, tooth: float, acceleration: float, late: float = 1.0
) -> tuple[float, float]:
    """The parabola-weighted mean pace of n periods, whose least-squares pace (Ω) is `pace`.

    Ω = Σ w_k s_k, w_k = 12(k - n/2) / (n(n+1)(n+2)), k = 0 … n. Σ w_k = 0, and summed by parts Ω is
    Σ W_j (s_j - s_{j-1}) with W_j = 6 j(n+1-j) / (n(n+1)(n+2)) ≥ 0, ΣW_j = 1: the mean of the
    periods under a parabola. It is off by Σ w_k ε_k, ε_k in [0, late) the stamps' lateness; about
    its middle that is less than ½Σ|w_k|·late: 3 / (2(n+1)) · late where n is even,
    3(n+1) / (2n(n+2)) · late where it is odd.

    With tooth error, edge k is met at most tooth · (greatest pace nearby) beside the instant of its
    place, which adds Σ|w_k| · tooth · that pace. The greatest pace rests on `acceleration`, pitches
    per tick²: somewhere between the edges the speed v is the mean one, and v² changes by at most
    2 · acceleration · way, the way being less than n + 4·tooth pitches. Where that leaves no speed
    at all the pace is unbounded, inf.
    """
    half = late * (3 * (n + 1) / (2 * n * (n + 2)) if n % 2 else 3 / (2 * (n + 1)))
    if tooth == 0.0:
        return max(pace - half, 0.0), pace + half
    fast, slow = mean_paces(n, ticks, tooth, late)
    change = 2 * acceleration * (n + 4 * tooth)
    pace_min = fast / math.sqrt(1 + change * fast**2)
    if 1 / slow**2 <= change:
        return pace_min, math.inf
    pace_max = 1 / math.sqrt(1 / slow**2 - change)
    reach = half + 2 * half * tooth * pace_max
    return max(pace - reach, pace_min), min(pace + reach, pace_max)


def mean_speed(n: int, ticks: int, scale: Scale) -> Estimate:
    """The mean speed between two rising edges of a, n ≥ 1 pitches and `ticks` > 1 apart (Π).

    Each stamp's lateness is even over its range: the variance of their difference is late²/6.
    """
    assumed = scale.assumptions
    value = scale.unit_kmh * n / ticks
    interval = scale.interval(*mean_paces(n, ticks, assumed.tooth_error, assumed.late_ticks))
    std = value * assumed.late_ticks / math.sqrt(6) / ticks
    return Estimate(value, *interval, std, MEAN, scale.premises())


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
    12σ² / (N(N²-1)), N = n + 1 edges, σ² = late²/12 of each stamp.
    """
    n = snapshot.window_n
    if not n:
        return present(snapshot, scale)
    pace = 6 * ((n + 2) * snapshot.sum_a - 2 * snapshot.sum_b) / (n * (n + 1) * (n + 2))
    tooth, late = scale.assumptions.tooth_error, scale.assumptions.late_ticks
    paces = weighted_paces(n, snapshot.window_ticks, pace, tooth, scale.acceleration, late)
    value = scale.unit_kmh / pace
    std = value * late / pace / math.sqrt((n + 1) * ((n + 1) ** 2 - 1))
    rests_on = scale.premises(*([scale.premise_acceleration] if tooth else []))
    return Estimate(value, *scale.interval(*paces), std, WEIGHTED, rests_on)


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
    quiet_s = max(snapshot.since_rise - delay - scale.assumptions.late_ticks, 0) * scale.tick_min_s
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
    contradict one another the wheel changed its speed faster: flagged `contradiction`, and the
    interval spans what lies between them.
    """
    low, high = 0.0, _trailing_kmh(snapshot, scale)
    spans = [(1, snapshot.period)] if snapshot.period_valid else []
    if snapshot.window_n:
        spans.append((snapshot.window_n, snapshot.window_ticks))
    if snapshot.since_rise >= scale.config.period_max:
        spans = []
    for n, ticks in spans:
        ago = ticks + snapshot.since_rise + scale.assumptions.late_ticks
        ago += scale.config.input_delay_ticks
        change = 3.6 * scale.assumptions.acceleration_max * ago * scale.tick_max_s * (1 + OUTWARD)
        mean = mean_speed(n, ticks, scale)
        low, high = max(low, mean.low_kmh - change), min(high, mean.high_kmh + change)
    flags = ("contradiction",) if low > high else ()
    low, high = min(low, high), max(low, high)
    rests_on = scale.premises(scale.premise_acceleration)
    return Estimate(None, low, high, None, PRESENT, rests_on, flags)
