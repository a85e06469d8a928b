"""What both models share: stimuli become lists of changes, the log becomes waveforms."""

from __future__ import annotations

import copy
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railgate.engines import Clock
from railgate.engines.signals import Port, check, chosen, parts, poked
from railgate.vital_output.model.clocks import clock_of, ticks_of
from railgate.vital_output.model.limits import limits
from railgate.vital_output.model.records import FAR, INPUTS, NONE, SIGNALS, STATE
from railgate.vital_output.model.run import run
from railgate.vital_output.spec import Config
from railgate.waves import Trace, Waveform

__all__ = ["Leap", "Output", "Wire", "channel_inputs", "channel_outputs"]

LOG_ROWS = 1 << 15
DISTURBING = ("rst", "stopped", "flip", "low", "high")
Rows = NDArray[np.int64]


@dataclass(frozen=True)
class Wire:
    """An input: its name and width, and which of INPUTS it is in which domains."""

    name: str
    width: int
    kind: str
    domains: tuple[int, ...] = (0,)


@dataclass(frozen=True)
class Output:
    """An output: its name and width, and its place in the log."""

    name: str
    width: int
    place: int


def channel_inputs(config: Config) -> dict[str, int]:
    """What a channel is told, with a loop or without; the width of each."""
    phase_bits = (config.cycle_ticks - 1).bit_length()
    one = dict.fromkeys(("command.valid", "time.valid", "test"), 1)
    return {"command.payload": 10, "time.index": 32, "time.phase": phase_bits, "boot": 16, **one}


def channel_outputs(config: Config, prefix: str, base: int) -> list[Output]:
    """What a channel shows; base: where it begins in the log."""
    found = [("command.ready", 1), ("link_tx", 1), ("pulses", config.outputs)]
    for of in config.fields:
        found += [(name, width) for name, width, _ in parts(of.name, of.width)]
    places = {"states": "states.0"}
    return [
        Output(prefix + name, width, base + SIGNALS.index(places.get(name, name)))
        for name, width in found
    ]


@dataclass
class State:
    """All that a model remembers: the run, the last value of each input, its changes that no edge
    of a domain has sampled yet, and when the lines were disturbed last."""

    now: int
    record: Any
    told: dict[str, int]
    changes: list[Rows]
    calm: Rows


class Leap:
    """Channels that run from event to event, as an engine by itself. No register can be poked."""

    def __init__(
        self,
        name: str,
        config: Config,
        clocks: Sequence[Clock],
        base: Fraction,
        signals: tuple[Sequence[Wire], Sequence[Output]],
    ) -> None:
        """clocks: of each domain, in a time base of `base` s."""
        self._name, self._config, self._period = name, config, base
        self._wires = {wire.name: wire for wire in signals[0]}
        self._outputs = {output.name: output for output in signals[1]}
        self._ports = [Port(w.name, w.width, False, False, (w.name,)) for w in signals[0]]
        self._limits = limits(config)
        self._clocks = [clock_of(clock, base) for clock in clocks]
        self._log = np.empty((LOG_ROWS, 3), np.int64)
        self._reach = ceil(max(clock.period / base for clock in clocks)) + 1
        self._state = State(
            now=0,
            record=self._start(),
            told=dict.fromkeys(self._wires, 0),
            changes=[np.empty((0, 3), np.int64)] * 3,
            calm=np.empty(0, np.int64),
        )

    def _start(self) -> Any:
        """The run before its first edge."""
        record = np.zeros(1, STATE)
        record["reach"] = self._reach
        record["domains"]["resetting"] = 1
        record["domains"]["frozen"] = NONE
        record["domains"]["event"] = record["domains"]["done"] = -1
        channels = record["channels"]
        channels["board"], channels["base"] = (0, 1), (0, len(SIGNALS))
        channels["shown"] = self._limits["starts"][0]
        channels["latch"] = channels["toggle"] = channels["arrival"] = FAR
        channels["senders"]["next"] = FAR
        for domain, clock in enumerate(self._clocks):
            record["clocks"][0, domain] = clock[0]
        return record

    def _key(self) -> tuple[Any, ...]:
        """What checkpoints must agree in."""
        return (self._config,)

    @property
    def now(self) -> int:
        return self._state.now

    @property
    def registers(self) -> tuple[str, ...]:
        """None."""
        return ()

    def poke(self, name: str, value: int) -> None:
        """Raises ValueError: there is no register."""
        poked({}, self._name, name, value)

    def checkpoint(self) -> Any:
        return self._key(), copy.deepcopy(self._state)

    def restore(self, checkpoint: Any) -> None:
        """Raises ValueError at a checkpoint of another model."""
        key, state = checkpoint
        if key != self._key():
            raise ValueError(f"a checkpoint must be of {self._key()}, not of {key}")
        self._state = copy.deepcopy(state)

    def advance(self, until: int, stimulus: Trace, outputs: Collection[str] | None = None) -> Trace:
        """Run the ticks now ≤ k < until. Raises ValueError."""
        wanted = [self._outputs[name] for name in chosen(outputs, list(self._outputs), self._name)]
        check(stimulus, self._name, self._period, self.now, until, self._ports)
        state, start = self._state, self.now
        if until > start:
            self._tell(stimulus, until)
        wants = np.zeros(2 * len(SIGNALS) + 1, np.int64)
        wants[[output.place for output in wanted]] = 1
        state.record["channels"]["wanted"] = wants[:-1].reshape(1, 2, -1)
        state.record["wanted"], state.record["fresh"] = wants[-1], 1
        self._run(start)
        shown = np.append(state.record["channels"]["shown"].ravel(), state.record["logged"])
        log = np.concatenate(self._run(until))
        state.now = until
        state.changes = [
            rows[cursor:].copy()
            for rows, cursor in zip(
                state.changes, state.record["domains"]["cursor"][0].tolist(), strict=True
            )
        ]
        log = log[log[:, 1].argsort(kind="stable")]
        waves = {}
        for output in wanted:
            first, last = log[:, 1].searchsorted([output.place, output.place + 1])
            ticks = np.append(start, log[first:last, 0])
            values = np.append(shown[output.place], log[first:last, 2]).view(np.uint64)
            waves[output.name] = Waveform.of(ticks, values, output.width)
        return Trace(waves, self._period, start, until)

    def _tell(self, stimulus: Trace, until: int) -> None:
        """Add the changes of the inputs from now on until then to those not sampled yet."""
        state, start = self._state, self.now
        rows = [[held] for held in state.changes]
        calm = [state.calm[state.calm >= start - self._reach], np.array([until])]
        for name, wave in stimulus.signals.items():
            first = int(wave.ticks.searchsorted(start, side="right")) - 1
            last = int(wave.ticks.searchsorted(until))
            ticks = np.maximum(wave.ticks[first:last], start)
            values = wave.values[first:last].astype(np.uint64).view(np.int64)
            if values[0] == state.told[name]:
                ticks, values = ticks[1:], values[1:]
            if not ticks.size:
                continue
            state.told[name] = int(values[-1])
            wire = self._wires[name]
            calm += [ticks] if wire.kind in DISTURBING else []
            kind = np.full(ticks.size, INPUTS.index(wire.kind))
            for d in wire.domains:
                edges = ticks_of(self._clocks[d], ticks)
                rows[d].append(np.stack([edges, kind, values], axis=1))
        joined = [np.concatenate(parts) for parts in rows]
        state.changes = [each[each[:, 0].argsort(kind="stable")] for each in joined]
        state.calm = np.unique(np.concatenate(calm))

    def _run(self, until: int) -> list[Rows]:
        """Run all edges before then; the log of it."""
        state, log, found, full = self._state, self._log, [], True
        given = (tuple(state.changes), state.calm, log, state.now, until)
        while full:
            log[0, 0] = 1
            full = run(state.record, self._limits, *given)
            found.append(log[1 : log[0, 0]].copy())
        return found
