"""The odometer's contract: configuration, fields, flags, and what happens in which tick.

Gateware and model are written from this page and from requirements ODO-1 … ODO-13, not from one
another. Ref: source 000, sections 1 and 2.

**Ticks.** A tick is one period of the reference clock; `x[k]` is what x holds during tick k. Tick
0 is the first after reset (`rst` is 1 in tick k: tick k + 1 is a new tick 0 and all is as at
start). In one tick the events below take place in the order in which they stand here, the strobe
last.

**Inputs (ODO-9).** Each of a, b passes two flip-flops, s[k] = x[k - 2], then the filter: f[3] =
s[2] (f is 0 before), so that the level at start is no edge. From k = 3 on: where s has now held
the level other than f[k] for `filter_ticks` + 1 successive ticks (counted from tick 3), f[k + 1] =
s[k], else f[k + 1] = f[k]. A level held for at most `filter_ticks` is *rejected*: the glitch event
is in the tick k ≥ 4 in which s[k] = f[k] again while s[k - 1] ≠ f[k - 1] and f[k] = f[k - 1]; it
is counted, of each channel by itself, and flagged GLITCH. An *edge* is in tick k ≥ 4 where f[k] ≠
f[k - 1]: `input_delay_ticks` = 3 + filter_ticks after the pin's change, for both edges of both
channels alike.

**Saturation.** T = k - k_rise, ticks since the last rising edge of a (k_rise = 0 before the
first). In the tick where T reaches `period_max` the flag SATURATED rises, and T stays there. In
the tick where a seated window (below) has lasted for `period_max` ticks since its boundary, it is
voided and flagged (SATURATED, WINDOW_VOID).

**Steps (ODO-5, ODO-6).** Forward is (a, b) = 00 → 10 → 11 → 01 → 00: `position` + 1 a step;
reverse is the way back: - 1. Both edges in one tick: ILLEGAL, counted, the position stays, the
direction becomes NONE. A step against the direction as it stands (NONE has no opposite) is a
reversal: counted, flagged REVERSAL. A reversal and an illegal transition void the window and make
the period under way unclean.

**Rising edge of a (ODO-2, ODO-4, ODO-6).** `pulses` + 1 (at its greatest value it stays:
SATURATED), `a_rising` + 1. If it is not the first since reset:
- `period` = T, `phase` = ticks from the last rising edge of a to the first rising edge of b in a
  later tick, before this one (at most period_max; 0 where there was none), `period_valid` = the
  period is clean: T < period_max and no reversal nor illegal transition in a tick after the last
  rising edge, up to and with this one.
- `phase_direction`: of a clean period FORWARD where T ≤ 8·phase ≤ 3·T, REVERSE where 5·T ≤
  8·phase ≤ 7·T, else NONE; of an unclean one NONE.
- clean, T ≤ `watch_ticks`, phase_direction NONE: one more towards `phase_fault_periods`, at which
  PHASE_FAULT is flagged, now and at each further one; any other period starts that count afresh.
- `armed` = T ≤ watch_ticks if it is clean; an unclean one leaves it.
- clean, T < `period_min_ticks`: OVERSPEED.

**Window (ODO-10).** Unseated at start. A rising edge of a seats it (that edge is the boundary,
the sums are 0); seated, it adds t = ticks since the boundary: `window_n` + 1, `window_ticks` = t,
`sum_a` += t, `sum_b` += sum_a. Where `window_n` is already `window_pulses`, it is voided instead
(WINDOW_OVERFLOW, WINDOW_VOID) and the edge seats it anew. To void: unseated, `window_n`,
`window_ticks` and both sums 0; the flag WINDOW_VOID only if it was seated. After a strobe a
seated window with n ≥ 1 goes on from its last edge as the new boundary; `window_n`,
`window_ticks` and the sums are 0.

**Rising edge of b.** `b_rising` + 1.

**Both channels (ODO-12).** A run counts the rising edges of one channel since one of the other: a
rise of a alone adds to the run of a and ends the run of b, and the other way round; both in one
tick end both runs. A rise of either channel more than `watch_ticks` after the last rise of either
(or after tick 0) first ends both runs and disarms (before this tick's own period may arm). In
each tick with a rise of either, a run of two or more while armed: MISMATCH; a run of
`missing_pulses` or more of a: B_MISSING, of b: A_MISSING. The runs stop counting at
missing_pulses. Of one tick, `armed` as it is after the period's update counts.

**Stamps (ODO-13, only where `stamp_depth` > 0).** Every tick with an edge puts one entry into a
FIFO: the low 32 bits of k, the levels f_a[k], f_b[k], and `lost`, whether entries were dropped
since the last one put. A FIFO that holds `stamp_depth` entries (put in ticks < k, less those
taken in ticks < k) drops it: STAMP_OVERFLOW. An entry put in tick k is offered from tick k +
`stamp_latency_ticks` on, in order, one per tick: valid is 1 and payload is the oldest such entry,
else valid and payload are 0. It is taken in each tick where valid and ready are 1.

**Strobe (ODO-6, ODO-7).** A strobe in tick s, with `busy[s]` = 0, is the gate of every sensor at
once. It latches all fields as they stand after the other events of tick s, `time` = s and
`number` + 1, then clears `pulses` and `flags` and moves the windows on. `busy` is 1 in ticks s +
1 … s + snapshot_latency_ticks - 1; in tick s + snapshot_latency_ticks all fields change together
and stay until the next snapshot. A strobe while busy joins the gate under way: it changes
nothing. Before the first snapshot all fields are 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum, IntFlag
from fractions import Fraction
from functools import cached_property

from railgate.bounds import require
from railgate.digest import digest
from railgate.field import Field

__all__ = ["STAMP", "STATE", "Assumptions", "Config", "Direction", "Field", "Flag"]


class Direction(IntEnum):
    """A direction of travel, as the registers code it."""

    NONE = 0
    FORWARD = 1
    REVERSE = 2


class Flag(IntFlag):
    """The sticky flags, cleared by the strobe that reports them (ODO-12)."""

    REVERSAL = 1 << 0
    ILLEGAL = 1 << 1
    GLITCH = 1 << 2
    MISMATCH = 1 << 3
    A_MISSING = 1 << 4
    B_MISSING = 1 << 5
    PHASE_FAULT = 1 << 6
    OVERSPEED = 1 << 7
    SATURATED = 1 << 8
    WINDOW_VOID = 1 << 9
    WINDOW_OVERFLOW = 1 << 10
    STAMP_OVERFLOW = 1 << 11


STAMP = (
    Field("ticks", 32, "low bits of the edge's tick", "ticks"),
    Field("a", 1, "level of a after the edge"),
    Field("b", 1, "level of b after the edge"),
    Field("lost", 1, "entries were dropped before this one"),
)
"""The fields of a stamp, from the least significant bit up (ODO-13)."""

STATE = (
    "position",
    "a_rising",
    "b_rising",
    "direction_changes",
    "illegal_transitions",
    "rejected_glitches",
)
"""The registers of each sensor that every engine can poke, as `sensor_0.position`."""


@dataclass(frozen=True, kw_only=True)
class Config:
    """What one odometer is built for. Raises ValueError at the first thing that does not hold.

    clock_hz: reference clock, Hz. sensors: how many two-channel sensors one strobe latches.
    pulses_per_rev: pulses per wheel revolution and channel. wheel_diameter_m: metres.
    filter_ticks: levels of the inputs of at most so many ticks vanish.
    overspeed_kmh: the fastest legitimate speed. minimum_kmh: below it neither phase nor pulse
    counts are supervised. phase_fault_periods, missing_pulses: how many in a row are a fault.
    period_bits, count_bits, time_bits: widths of period counters, event counters, time.
    window_pulses: the most periods of one window. stamp_depth: entries of the stamp FIFO, 0: none.
    """

    clock_hz: int = 16_000_000
    sensors: int = 2
    pulses_per_rev: int = 200
    wheel_diameter_m: Fraction = Fraction(65, 100)
    filter_ticks: int = 0
    overspeed_kmh: Fraction = Fraction(220)
    minimum_kmh: Fraction = Fraction(3)
    phase_fault_periods: int = 4
    missing_pulses: int = 8
    period_bits: int = 32
    count_bits: int = 32
    time_bits: int = 48
    window_pulses: int = 8191
    stamp_depth: int = 0

    snapshot_latency_ticks = 16
    """From strobe to fields: room for pipelines of any depth below it."""
    stamp_latency_ticks = 4

    def __post_init__(self) -> None:
        require(
            self,
            ("clock_hz", 1_000, 10**10),
            ("sensors", 1, 16),
            ("pulses_per_rev", 1, 100_000),
            ("wheel_diameter_m", Fraction(1, 100), 10),
            ("filter_ticks", 0, 65_535),
            ("overspeed_kmh", Fraction(1, 10), 2_000),
            ("minimum_kmh", Fraction(1, 100), 2_000),
            ("phase_fault_periods", 1, 255),
            ("missing_pulses", 2, 255),
            ("period_bits", 4, 40),
            ("count_bits", 8, 48),
            ("time_bits", 16, 63),
            ("window_pulses", 1, 2**20),
            ("stamp_depth", 0, 65_536),
        )
        if self.minimum_kmh >= self.overspeed_kmh:
            raise ValueError(
                f"minimum_kmh must be below overspeed_kmh, {float(self.overspeed_kmh):g}, "
                f"not {float(self.minimum_kmh):g}"
            )
        if self.period_min_ticks < 8:
            raise ValueError(
                f"a period at overspeed_kmh must last at least 8 ticks of clock_hz, "
                f"not {self.period_min_ticks}"
            )
        if 2 * (self.filter_ticks + 1) > self.period_min_ticks:
            raise ValueError(
                f"filter_ticks must be below the shortest half-period at overspeed, at most "
                f"{self.period_min_ticks // 2 - 1}, not {self.filter_ticks}"
            )
        if self.watch_ticks >= self.period_max:
            raise ValueError(
                f"period_bits must hold the period at minimum_kmh, at least "
                f"{(self.watch_ticks + 1).bit_length()}, not {self.period_bits}"
            )
        if self.sum_b_bits > 64:
            raise ValueError(
                f"window_pulses and period_bits must leave the Ω sums at most 64 bits, "
                f"not {self.sum_b_bits}"
            )

    @cached_property
    def digest(self) -> int:
        """Of all of the configuration (SYS-5)."""
        return digest(self)

    @property
    def pitch_m(self) -> float:
        """The wheel's way in one period, metres."""
        return math.pi * float(self.wheel_diameter_m) / self.pulses_per_rev

    def period_ticks(self, speed_kmh: float) -> float:
        """The period at a constant speed, ticks."""
        return 3.6 * self.pitch_m * self.clock_hz / speed_kmh

    @property
    def period_min_ticks(self) -> int:
        """The shortest period that is no overspeed."""
        return math.floor(self.period_ticks(float(self.overspeed_kmh)))

    @property
    def watch_ticks(self) -> int:
        """The longest period at which phase and pulse counts are supervised."""
        return math.ceil(self.period_ticks(float(self.minimum_kmh)))

    @property
    def period_max(self) -> int:
        """Where period counters saturate."""
        return (1 << self.period_bits) - 1

    @property
    def input_delay_ticks(self) -> int:
        """From a change of a pin to its edge."""
        return 3 + self.filter_ticks

    @property
    def window_bits(self) -> int:
        return self.window_pulses.bit_length()

    @property
    def sum_a_bits(self) -> int:
        """Σ t_k of window_pulses edges, each t_k at most period_max: cannot overflow."""
        return (self.window_pulses * self.period_max).bit_length()

    @property
    def sum_b_bits(self) -> int:
        """Σ of the running sum_a over window_pulses edges: cannot overflow."""
        n = self.window_pulses
        return (n * (n + 1) // 2 * self.period_max).bit_length()

    @property
    def common_fields(self) -> tuple[Field, ...]:
        """The fields that all sensors of one snapshot share (ODO-7)."""
        return (
            Field("number", self.count_bits, "of the snapshot, from 1, modulo its width"),
            Field("time", self.time_bits, "the strobe's tick, modulo its width", "ticks"),
        )

    @property
    def sensor_fields(self) -> tuple[Field, ...]:
        """The fields of each sensor, in the order of the burst (ODO-8)."""
        t, c = self.period_bits, self.count_bits
        return (
            Field("pulses", c, "rising edges of a since the last snapshot, saturating"),
            Field("a_rising", c, "rising edges of a since reset, modulo its width"),
            Field("b_rising", c, "rising edges of b since reset, modulo its width"),
            Field("position", c, "signed steps since reset, modulo its width", "¼ pitch", True),
            Field("direction_changes", c, "reversals since reset, modulo its width"),
            Field("illegal_transitions", c, "two-bit transitions since reset, modulo its width"),
            Field("rejected_glitches", c, "rejected by both filters since reset, modulo its width"),
            Field("level_a", 1, "filtered level of a"),
            Field("level_b", 1, "filtered level of b"),
            Field("direction", 2, "of the last step, NONE after an illegal transition"),
            Field("phase_direction", 2, "of the last period, by its phase"),
            Field("period", t, "the last one, between rising edges of a", "ticks"),
            Field("period_valid", 1, "no reversal, illegal transition or saturation in it"),
            Field("phase", t, "of the last period: rising a to rising b", "ticks"),
            Field("since_rise", t, "since the last rising edge of a or reset, saturating", "ticks"),
            Field("since_edge", t, "since the last edge of any kind or reset, saturating", "ticks"),
            Field("window_seated", 1, "the window has a boundary edge"),
            Field("window_n", self.window_bits, "its periods since the boundary edge"),
            Field("window_ticks", t, "from its boundary edge to its last edge", "ticks"),
            Field("sum_a", self.sum_a_bits, "Σ t_k, t_k from the boundary edge to edge k", "ticks"),
            Field("sum_b", self.sum_b_bits, "Σ of the running sum_a", "ticks"),
            Field("flags", len(Flag), "what happened since the last snapshot, see Flag"),
        )


@dataclass(frozen=True, kw_only=True)
class Assumptions:
    """What a guaranteed interval rests on beside the tick (ODO-14). Raises ValueError.

    crystal_ppm: the reference clock's tolerance. diameter_tolerance_m: of the wheel, metres.
    tooth_error: greatest deviation of a rising edge of a from its place, in pitches.
    acceleration_max: greatest acceleration and deceleration of the train, m/s².
    jerk_max: greatest change of the acceleration within one window, m/s³; 0: it is constant.
    late_ticks: how far a stamp can be behind its edge: 1, of pins sampled coarser before more.
    """

    crystal_ppm: float = 100.0
    diameter_tolerance_m: float = 0.0
    tooth_error: float = 0.0
    acceleration_max: float = 1.5
    jerk_max: float = 0.0
    late_ticks: float = 1.0

    def __post_init__(self) -> None:
        require(
            self,
            ("crystal_ppm", 0, 10_000),
            ("diameter_tolerance_m", 0, 0.1),
            ("tooth_error", 0, 0.25),
            ("acceleration_max", 0.01, 100),
            ("jerk_max", 0, 100),
            ("late_ticks", 1, 1e9),
        )
