"""What the registers say: snapshots, stamps, and what happened between two snapshots."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from railgate.odometer.spec import STAMP, Config, Direction, Flag
from railgate.waves.trace import Trace
from railgate.waves.waveform import Ticks, Values, Waveform

__all__ = [
    "Counts",
    "Snapshot",
    "Stamps",
    "between",
    "direction",
    "distance_m",
    "phase_deg",
    "snapshots",
    "stamps",
    "window_edges",
]


@dataclass(frozen=True)
class Snapshot:
    """All fields of one sensor, latched in one tick: `spec.Config.common_fields`, then
    `sensor_fields`, in their units (ODO-7)."""

    number: int
    time: int
    pulses: int
    a_rising: int
    b_rising: int
    position: int
    direction_changes: int
    illegal_transitions: int
    rejected_glitches: int
    level_a: int
    level_b: int
    direction: int
    phase_direction: int
    period: int
    period_valid: int
    phase: int
    since_rise: int
    since_edge: int
    window_seated: int
    window_n: int
    window_ticks: int
    sum_a: int
    sum_b: int
    flags: int

    @property
    def causes(self) -> Flag:
        """The flags by name."""
        return Flag(self.flags)


def snapshots(trace: Trace, config: Config, sensor: int = 0) -> list[Snapshot]:
    """The snapshots of one sensor in a run, in order: one wherever `number` changes but by reset.

    trace: holds `number`, `time` and `sensor.{sensor}.<field>`. Raises ValueError where one lacks.
    """
    at = trace["number"].ticks[1:]
    at = at[(trace["number"].at(at) != 0) | (trace["time"].at(at) != 0)]
    names = [field.name for field in config.common_fields]
    names += [f"sensor.{sensor}.{field.name}" for field in config.sensor_fields]
    columns = (trace[name].at(at).tolist() for name in names)
    return [Snapshot(*row) for row in zip(*columns, strict=True)]


@dataclass(frozen=True, eq=False)
class Stamps:
    """The edges from the stamp FIFO (ODO-13), in order.

    ticks: int64, unwrapped. a, b: levels after the edge. lost: entries were dropped before it.
    All of shape (edges,).
    """

    ticks: Ticks
    a: NDArray[np.bool_]
    b: NDArray[np.bool_]
    lost: NDArray[np.bool_]

    @cached_property
    def rises(self) -> Ticks:
        """The ticks of the rising edges of a that are known as such.

        Left out are an edge right after a loss and the very first: the level before is unknown.
        """
        rising: Ticks = self.ticks[1:][self.a[1:] & ~self.a[:-1] & ~self.lost[1:]]
        return rising


def _taken(trace: Trace, name: str, ready: Waveform | None) -> tuple[Ticks, Values]:
    """When each entry of a stream was taken, and what it was.

    Successive entries differ, since their ticks do: an entry is offered over one stretch of
    constant valid and payload, and was taken if `ready` is 1 in the last tick of that stretch.
    """
    valid, payload = trace[f"{name}.valid"], trace[f"{name}.payload"]
    begin = np.sort(np.concatenate([valid.ticks, payload.ticks]), kind="stable")
    begin = begin[np.append(True, begin[1:] != begin[:-1])]
    last = np.append(begin[1:], trace.end) - 1
    taken = valid.at(begin) != 0
    if ready is not None:
        taken &= ready.at(last) != 0
    return last[taken], payload.at(begin[taken])


def stamps(trace: Trace, config: Config, sensor: int = 0, ready: Waveform | None = None) -> Stamps:
    """The stamps taken from one sensor's FIFO in a run.

    ready: the stimulus `sensor.{sensor}.stamps.ready`, None: 1 throughout. An entry must have been
    taken within 2³² ticks of its edge. Raises ValueError if the configuration has no stamps.
    """
    if not config.stamp_depth:
        raise ValueError("stamps need a stamp_depth of at least 1, not 0")
    seen, payload = _taken(trace, f"sensor.{sensor}.stamps", ready)
    parts, low = {}, 0
    for field in STAMP:
        parts[field.name] = (payload.astype(np.int64) >> low) & ((1 << field.width) - 1)
        low += field.width
    ticks = seen - ((seen - parts["ticks"]) & 0xFFFF_FFFF)
    return Stamps(ticks, *(parts[name] != 0 for name in ("a", "b", "lost")))


def window_edges(stamps: Stamps, snapshot: Snapshot, config: Config) -> Ticks | None:
    """The rising edges of a in a snapshot's window, boundary first: shape (window_n + 1,).

    None where the stamps do not hold them all: the last must be `since_rise` before the strobe and
    the first `window_ticks` before the last, which no window with a lost stamp satisfies. The
    stamps must span less than 2^time_bits ticks.
    """
    rises, n = stamps.rises, snapshot.window_n
    if not snapshot.window_seated or not rises.size:
        return None
    first = int(rises[0])
    last = first + (snapshot.time - snapshot.since_rise - first) % (1 << config.time_bits)
    at = int(np.searchsorted(rises, last))
    if at >= rises.size or rises[at] != last or at < n:
        return None
    edges: Ticks = rises[at - n : at + 1]
    return edges if int(edges[-1] - edges[0]) == snapshot.window_ticks else None


@dataclass(frozen=True)
class Counts:
    """What happened between two snapshots of one sensor, however many lie between (ODO-7).

    ticks: elapsed. snapshots: 1 for successive ones. pulses, b_pulses: rising edges. steps: of the
    position, signed, in ¼ pitch; the others are counts.
    """

    ticks: int
    snapshots: int
    pulses: int
    b_pulses: int
    steps: int
    direction_changes: int
    illegal_transitions: int
    rejected_glitches: int


def between(older: Snapshot, newer: Snapshot, config: Config) -> Counts:
    """The counts from `older` to `newer`, exact as long as each is below 2^count_bits (the steps:
    below half of that either way) and the time below 2^time_bits ticks."""
    counted, half = 1 << config.count_bits, 1 << (config.count_bits - 1)

    def more(name: str) -> int:
        return int(getattr(newer, name) - getattr(older, name)) % counted

    return Counts(
        ticks=(newer.time - older.time) % (1 << config.time_bits),
        snapshots=more("number"),
        pulses=more("a_rising"),
        b_pulses=more("b_rising"),
        steps=(more("position") + half) % counted - half,
        direction_changes=more("direction_changes"),
        illegal_transitions=more("illegal_transitions"),
        rejected_glitches=more("rejected_glitches"),
    )


def direction(older: Snapshot, newer: Snapshot, config: Config) -> Direction:
    """The direction over a window: that of the steps, where nothing speaks against it, else NONE.

    Against it speak a reversal or an illegal transition between the snapshots, the last step, and
    the phase of a period that ended between them (one without a clear phase does not).
    """
    counts = between(older, newer, config)
    if not counts.steps or counts.direction_changes or counts.illegal_transitions:
        return Direction.NONE
    way = Direction.FORWARD if counts.steps > 0 else Direction.REVERSE
    phase = Direction(newer.phase_direction) if counts.pulses else Direction.NONE
    agree = newer.direction == way and phase in (way, Direction.NONE)
    return way if agree else Direction.NONE


def distance_m(steps: int | Iterable[Counts], config: Config) -> float:
    """The wheel's way for a number of steps, or for all the steps of some counts, metres, signed.

    The steps are summed as integers and made metres once, so nothing drifts (ODO-14).
    """
    total = steps if isinstance(steps, int) else sum(counts.steps for counts in steps)
    return math.pi * float(config.wheel_diameter_m * total / (4 * config.pulses_per_rev))


def phase_deg(snapshot: Snapshot) -> float | None:
    """φ = 360° · Δt / T of the last period; None where there was none or it is unclean (ODO-4)."""
    return 360 * snapshot.phase / snapshot.period if snapshot.period_valid else None
