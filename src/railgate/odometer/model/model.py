"""The odometer from event to event: the same outputs as the gateware's, tick for tick (SYS-2).

Its cost goes with edges, strobes and ready changes, not with ticks.
"""

from __future__ import annotations

import copy
from collections.abc import Collection
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railgate.engines.columns import Columns
from railgate.engines.inputs import NO_TICKS, Input, stretches
from railgate.engines.signals import Port, Register, check, chosen, poked
from railgate.odometer.model.kernel import SNAPSHOT, edges, limits, new_sensor, run
from railgate.odometer.model.snapshots import busy, gates
from railgate.odometer.model.stamping import PAYLOAD_BITS, Fifo
from railgate.odometer.spec import STATE, Config, Field, Flag
from railgate.waves import Trace, Waveform
from railgate.waves.waveform import Ticks

__all__ = ["Model"]

NAME = "odometer"

Changes = tuple[Ticks, NDArray[Any]]


@dataclass
class Sensor:
    """One sensor: its record, the changes of a and b that have had no effect yet, its stamps."""

    record: Any
    pins: tuple[Ticks, Ticks] = (NO_TICKS, NO_TICKS)
    fifo: Fifo = field(default_factory=Fifo)

    def settle(self, inputs: tuple[Input, Input], start: int, fresh: bool) -> tuple[Ticks, Ticks]:
        """The changes of a and b to be run; after a reset the levels at `start` are no change."""
        pins = []
        for name, seen, new in zip(("level_a", "level_b"), self.pins, inputs, strict=True):
            if fresh:
                self.record[name] = new.level
            before = int(self.record[name][0]) ^ (seen.size & 1)
            pins.append(new.after(seen, before, start))
        return pins[0], pins[1]


@dataclass
class State:
    """All that a model remembers. The snapshot of index 0 is shown, one of index 1 is under way."""

    now: int
    origin: int
    held: dict[str, int]
    number: int
    sensors: list[Sensor]
    ticks: Ticks
    common: NDArray[np.int64]
    rows: Any


@dataclass(frozen=True)
class Part:
    """The outputs of a stretch without reset: snapshots, busy, and what each FIFO offers."""

    ticks: Ticks
    common: NDArray[np.int64]
    rows: Any
    busy: Changes
    stamps: list[Changes]


class Model:
    """One odometer as an engine by itself.

    Inputs: `strobe`, `rst`, `sensor.<i>.a`, `sensor.<i>.b`, with stamps `sensor.<i>.stamps.ready`;
    each 1 bit. Outputs: `busy`, the configuration's common fields, its fields of each sensor as
    `sensor.<i>.<field>`, with stamps `sensor.<i>.stamps.valid` and `.payload` (spec.STAMP as one
    number, its first field least significant). A poke comes before the events of tick `now`.
    """

    _state: State

    def __init__(self, config: Config) -> None:
        self._config = config
        self._limits = limits(config)
        self._period = Fraction(1, config.clock_hz)
        self._common, self._fields = columns(config.common_fields), columns(config.sensor_fields)
        pins = ("a", "b", "stamps.ready") if config.stamp_depth else ("a", "b")
        names = [f"sensor.{i}.{pin}" for i in range(config.sensors) for pin in pins]
        names += ["strobe", "rst"]
        self._inputs = [Port(name, 1, False, False, tuple(name.split("."))) for name in names]
        self._outputs = _outputs(config)
        self._registers = _registers(config)
        self._reset(0, 0, dict.fromkeys(names, 0))

    @property
    def now(self) -> int:
        return self._state.now

    @property
    def registers(self) -> tuple[str, ...]:
        """The names that `poke` takes: spec.STATE of each sensor."""
        return tuple(self._registers)

    def poke(self, name: str, value: int) -> None:
        """Force a register, as `sensor_0.position`. Raises ValueError."""
        poked(self._registers, NAME, name, value)
        sensor, _, register = name.partition(".")
        self._state.sensors[int(sensor.removeprefix("sensor_"))].record[register] = value

    def checkpoint(self) -> Any:
        return self._config, copy.deepcopy(self._state)

    def restore(self, checkpoint: Any) -> None:
        """Raises ValueError at a checkpoint of another configuration."""
        config, state = checkpoint
        if config != self._config:
            raise ValueError(f"a checkpoint must be of {self._config}, not of {config}")
        self._state = copy.deepcopy(state)

    def advance(self, until: int, stimulus: Trace, outputs: Collection[str] | None = None) -> Trace:
        """Run the ticks now ≤ k < until. Raises ValueError."""
        wanted = chosen(outputs, self._outputs, NAME)
        check(stimulus, NAME, self._period, self.now, until, self._inputs)
        state, start = self._state, self.now
        inputs = {name: Input(level, NO_TICKS) for name, level in state.held.items()}
        if until > start:
            for name, wave in stimulus.signals.items():
                inputs[name] = Input.of(wave, start, until)
        parts, held = [], {name: given.last for name, given in inputs.items()}
        for end, origin in stretches(inputs["rst"], start, until):
            parts.append(self._run(inputs, end))
            if origin is not None:
                self._reset(end, origin, held)
                if end < until:
                    parts.append(self._part(end, end, []))
        self._state.held, self._state.now = held, until
        return Trace(self._waves(parts, wanted), self._period, start, until)

    def _reset(self, end: int, origin: int, held: dict[str, int]) -> None:
        """All as at start: reset in the ticks end - 1 … origin - 1, of which the last is 0 again.

        The outputs are 0 from `end` on.
        """
        config = self._config
        self._state = State(
            now=origin,
            origin=origin,
            held=held,
            number=0,
            sensors=[Sensor(new_sensor(config, origin)) for _ in range(config.sensors)],
            ticks=np.array([end], np.int64),
            common=np.zeros((1, len(config.common_fields)), np.int64),
            rows=np.zeros((config.sensors, 1), SNAPSHOT),
        )

    def _run(self, inputs: dict[str, Input], end: int) -> Part:
        """Run up to `end`, without a reset on the way."""
        state, latency = self._state, self._config.snapshot_latency_ticks
        start, origin = state.now, state.origin
        given = {name: wave.part(start, end) for name, wave in inputs.items()}
        strobe = given["strobe"]
        opened = gates(strobe.changes, strobe.level, start, end, int(state.ticks[-1]), latency)
        self._open(opened)
        offers = []
        for i, sensor in enumerate(state.sensors):
            pins = sensor.settle(
                (given[f"sensor.{i}.a"], given[f"sensor.{i}.b"]), start, start == origin
            )
            dropped = NO_TICKS
            if self._config.stamp_depth:
                ready = given[f"sensor.{i}.stamps.ready"]
                offered, what, dropped = sensor.fifo.run(
                    edges(self._limits, sensor.record, pins, end),
                    (ready.changes, ready.level),
                    (start, end),
                    origin,
                    self._config.stamp_depth,
                    self._config.stamp_latency_ticks,
                )
                offers.append((offered, what))
            rows = state.rows[i]
            first = rows.size - opened.size
            used = run(self._limits, sensor.record, pins, opened, rows, first, origin, end)
            sensor.pins = pins[0][used[0] :].copy(), pins[1][used[1] :].copy()
            if dropped.size:
                flag_overflow(sensor.record, rows[first:], opened, dropped)
        state.now = end
        return self._part(start, end, offers)

    def _open(self, opened: Ticks) -> None:
        """Make room for the snapshots of the gates that open at these ticks."""
        state, config = self._state, self._config
        before = state.ticks.size
        number = state.number + 1 + np.arange(opened.size)
        common = np.empty((before + opened.size, 2), np.int64)
        common[:before] = state.common
        common[before:, 0] = number & ((1 << config.count_bits) - 1)
        common[before:, 1] = (opened - state.origin) & ((1 << config.time_bits) - 1)
        rows = np.empty((config.sensors, before + opened.size), SNAPSHOT)
        rows[:, :before] = state.rows
        state.ticks = np.concatenate([state.ticks, opened + config.snapshot_latency_ticks])
        state.number += opened.size
        state.common, state.rows = common, rows

    def _part(self, start: int, end: int, offers: list[Changes]) -> Part:
        """The outputs of start ≤ tick < end; of the snapshots only the last shown is kept."""
        state, latency = self._state, self._config.snapshot_latency_ticks
        first = max(int(np.searchsorted(state.ticks, start, side="right")) - 1, 0)
        last = max(int(np.searchsorted(state.ticks, end, side="left")), first + 1)
        ticks = state.ticks[first:last].copy()
        ticks[0] = start
        if not offers and self._config.stamp_depth:
            nothing = np.array([start], np.int64), np.array([-1], np.int64)
            offers = [nothing] * self._config.sensors
        part = Part(
            ticks,
            state.common[first:last],
            state.rows[:, first:last],
            busy(state.ticks[first + 1 :], start, end, latency),
            offers,
        )
        state.ticks = state.ticks[last - 1 :].copy()
        state.common = state.common[last - 1 :].copy()
        state.rows = state.rows[:, last - 1 :].copy()
        return part

    def _waves(self, parts: list[Part], names: list[str]) -> dict[str, Waveform]:
        ticks = joined([part.ticks for part in parts])
        waves = {"busy": Waveform.of(*join([part.busy for part in parts]))}
        waves |= self._common.waves(ticks, joined([part.common for part in parts]), names)
        for i in range(self._config.sensors):
            rows = joined([part.rows[i] for part in parts])
            table = rows.view(np.int64).reshape(ticks.size, -1)
            waves |= self._fields.waves(ticks, table, names, f"sensor.{i}.")
            if self._config.stamp_depth:
                at, what = join([part.stamps[i] for part in parts])
                waves[f"sensor.{i}.stamps.valid"] = Waveform.of(at, what >= 0)
                waves[f"sensor.{i}.stamps.payload"] = Waveform.of(
                    at, np.maximum(what, 0), PAYLOAD_BITS
                )
        return {name: waves[name] for name in names}


def columns(fields: tuple[Field, ...]) -> Columns:
    return Columns((field.name, field.width, field.signed) for field in fields)


def _outputs(config: Config) -> list[str]:
    names = ["busy", *(field.name for field in config.common_fields)]
    of_sensor = [field.name for field in config.sensor_fields]
    of_sensor += ["stamps.valid", "stamps.payload"] if config.stamp_depth else []
    return names + [f"sensor.{i}.{name}" for i in range(config.sensors) for name in of_sensor]


def _registers(config: Config) -> dict[str, Register]:
    shapes = {of.name: (of.width, of.signed) for of in config.sensor_fields}
    names = [(f"sensor_{i}.{name}", name) for i in range(config.sensors) for name in STATE]
    return {path: Register(path, *shapes[name]) for path, name in names}


def flag_overflow(record: Any, rows: Any, opened: Ticks, dropped: Ticks) -> None:
    """Flag dropped stamps in the snapshots at whose gates they are reported, or keep the flag."""
    reported = np.searchsorted(opened, dropped)
    rows["flags"][reported[reported < opened.size]] |= int(Flag.STAMP_OVERFLOW)
    if reported[-1] == opened.size:
        record["flags"] |= int(Flag.STAMP_OVERFLOW)


def joined(arrays: list[Any]) -> Any:
    return arrays[0] if len(arrays) == 1 else np.concatenate(arrays)


def join(changes: list[Changes]) -> Changes:
    return joined([ticks for ticks, _ in changes]), joined([what for _, what in changes])
