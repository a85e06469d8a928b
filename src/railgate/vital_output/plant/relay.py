"""The relays as a function of both pulse trains (DRV-13)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor

import numpy as np

from railgate.bounds import require
from railgate.engines import Clock
from railgate.vital_output.plant.edges import Edges
from railgate.vital_output.spec import Config
from railgate.waves import Trace, Waveform
from railgate.waves.waveform import Ticks

__all__ = ["DEFECTS", "FEEDBACK", "RelayTimes", "Stage", "combined", "contacts"]

DEFECTS = ("welded", "broken", "rogue_1", "rogue_2")
"""What can be wrong with a relay, a signal each with a bit for each output."""

FEEDBACK = ("open_1", "open_2", "stuck_1", "stuck_2", "contact_open", "contact_stuck")
"""What can be wrong with what the FPGAs see of their pulses and of the contact, likewise."""

LEAST_PERIOD = 8
"""Ticks, so that two flip-flops see each half of it."""

LOW = Waveform.of([0], [0])


@dataclass(frozen=True, kw_only=True)
class RelayTimes:
    """The clock in which the relays' times are counted, and how long they take to close and open.

    Raises ValueError.
    """

    clock_hz: int = 1_000_000
    pick_up_s: Fraction = Fraction(3, 100)
    release_s: Fraction = Fraction(1, 50)

    def __post_init__(self) -> None:
        require(self, ("clock_hz", 1_000, 10**9))
        for name in ("pick_up_s", "release_s"):
            if not 0 < (value := getattr(self, name)) <= 10:
                raise ValueError(f"{name} must be above 0 and at most 10 s, not {float(value):g}")

    @property
    def pick_up_ticks(self) -> int:
        """From the coil's current to the closed contact, at least 1."""
        return ceil(self.pick_up_s * self.clock_hz)

    @property
    def release_ticks(self) -> int:
        """From the loss of the coil's current to the open contact, at least 1."""
        return ceil(self.release_s * self.clock_hz)


@dataclass(frozen=True)
class Stage:
    """The pulse train's period in ticks of the relays' clock: what a dynamic stage is built for.

    low, high: between them a period is right. Raises ValueError where the clock is too slow for it.
    """

    period: int
    low: int
    high: int

    @classmethod
    def of(cls, config: Config, times: RelayTimes) -> Stage:
        period = round(Fraction(config.period_ticks * times.clock_hz, config.clock_hz))
        if period < LEAST_PERIOD:
            raise ValueError(
                f"the relays' clock_hz must be at least {LEAST_PERIOD} times that of the pulse "
                f"train, {config.pulse_hz}, not {times.clock_hz}"
            )
        part = config.pulse_tolerance
        return cls(period, ceil(period * (1 - part)), floor(period * (1 + part)))


def contacts(config: Config, times: RelayTimes, clock: Clock, run: Trace) -> Waveform:
    """The relays' contacts over the time of `run`, bit i of output i, in femtoseconds.

    clock: of the relays. run: signals fpga_1.pulses and fpga_2.pulses from tick 0 on, and those of
    `relay.welded`, … (see DEFECTS) that are not 0 throughout, beside others. Raises ValueError.
    """
    if run.start:
        raise ValueError(f"the pulses must begin in tick 0, not {run.start}")
    edges, stage = Edges(clock), Stage.of(config, times)
    end = edges.count(run.end)
    names = ("fpga_1.pulses", "fpga_2.pulses", *(f"relay.{name}" for name in DEFECTS))
    seen = [edges.sampled(run[name]) if name in run.signals else LOW for name in names]
    closed = []
    for output in range(config.outputs):
        pulse_1, pulse_2, welded, broken, *rogues = (_bit(wave, output) for wave in seen)
        alive_1, alive_2 = (
            _alive(stage, _fed(stage, pulse, rogue, end))
            for pulse, rogue in zip((pulse_1, pulse_2), rogues, strict=True)
        )
        closed.append(_contact(times, _coil(alive_1, alive_2, broken), welded, end))
    whole = combined(closed)
    return edges.wave(whole.ticks, whole.values, config.outputs, run.end)


def combined(waves: Sequence[Waveform]) -> Waveform:
    """Signals of one bit as one signal, the first one's bit the lowest."""
    ticks = np.unique(np.concatenate([wave.ticks for wave in waves]))
    values = np.zeros(ticks.size, np.uint64)
    for bit, wave in enumerate(waves):
        values |= wave.at(ticks).astype(np.uint64) << np.uint64(bit)
    return Waveform.of(ticks, values, len(waves))


def _bit(wave: Waveform, bit: int) -> Waveform:
    return Waveform.of(wave.ticks, wave.values >> bit & 1)


def _fed(stage: Stage, pulse: Waveform, rogue: Waveform, end: int) -> Waveform:
    """What a stage is fed with: the pulse, or while `rogue` is 1 the train of its own."""
    if rogue == LOW:
        return pulse
    turns = np.arange(2 * (1 + end // stage.period))
    train = turns // 2 * stage.period + turns % 2 * (stage.period // 2)
    ticks = np.unique(np.concatenate([pulse.ticks, rogue.ticks, train]))
    own = ticks % stage.period < stage.period // 2
    return Waveform.of(ticks, np.where(rogue.at(ticks), own, pulse.at(ticks)))


def _alive(stage: Stage, fed: Waveform) -> Waveform:
    """Whether the train is alive, from what the two flip-flops make of it two ticks later."""
    high = fed.values != 0
    rises = 2 + fed.ticks[high & np.append(True, ~high[:-1])]
    since = np.diff(rises, prepend=rises[:1] - stage.high - 1)
    right = (since >= stage.low) & (since <= stage.high)
    ends = rises + stage.high
    ends = np.minimum(ends, np.append(rises[1:], ends[-1:]))
    ticks = np.stack([rises, ends], axis=1).ravel() + 1
    values = np.stack([right, np.zeros_like(right)], axis=1).ravel()
    return Waveform.of(np.append(0, ticks), np.append(False, values))


def _coil(alive_1: Waveform, alive_2: Waveform, broken: Waveform) -> Waveform:
    ticks = np.unique(np.concatenate([wave.ticks for wave in (alive_1, alive_2, broken)]))
    return Waveform.of(ticks, alive_1.at(ticks) & alive_2.at(ticks) & ~broken.at(ticks) & 1)


def _contact(times: RelayTimes, coil: Waveform, welded: Waveform, end: int) -> Waveform:
    """Closes and opens where the coil has held for the whole time that it takes."""
    closed, ticks, values = 0, [0], [0]
    stops = np.append(coil.ticks[1:], end).tolist()
    for start, stop, on in zip(coil.ticks.tolist(), stops, coil.values.tolist(), strict=True):
        if on == closed:
            continue
        moves = start + (times.pick_up_ticks if on else times.release_ticks) - 1
        if closed:
            moves = _free(welded, moves, end)
        if moves < stop:
            closed = on
            ticks.append(moves + 1)
            values.append(on)
    return Waveform.of(ticks, values)


def _free(welded: Waveform, tick: int, end: int) -> int:
    """The first tick from `tick` on in which the contact is not welded."""
    if not welded.at(tick):
        return tick
    later: Ticks = welded.falling()
    later = later[later > tick]
    return int(later[0]) if later.size else end
