"""The position link from event to event: the same outputs as the gateware's, tick for tick (SYS-2).

Its cost goes with cycles and with edges of UEF and DATA; CLK costs nothing unless asked for.
"""

from __future__ import annotations

import copy
from collections.abc import Collection
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railgate.engines.inputs import NO_TICKS, Filter, Input, stretches
from railgate.engines.signals import Port, check, chosen, poked
from railgate.position_link.model.line import FOUND, LINE, complete, cycles
from railgate.position_link.model.link import LINK, Table, first_row, judge, limits
from railgate.position_link.model.outputs import Outputs, Part
from railgate.position_link.model.words import objections, parts_of
from railgate.position_link.spec import Config, Edge
from railgate.waves import Trace
from railgate.waves.waveform import Ticks

__all__ = ["Model"]

NAME = "position link"
INPUTS = ("uef", "data", "rst")


@dataclass
class Pin:
    """UEF or DATA: its filter, and the edges and glitches that are not accounted for yet.

    Edges are in ticks of the pin, glitches in those in which they are told.
    """

    filter: Filter
    edges: Ticks = field(default_factory=lambda: NO_TICKS.copy())
    glitches: Ticks = field(default_factory=lambda: NO_TICKS.copy())

    def take(self, pin: Input, start: int, end: int) -> None:
        edges, glitches = self.filter.take(pin, start, end)
        self.edges = np.concatenate([self.edges, edges])
        self.glitches = np.concatenate([self.glitches, glitches])

    def told(self, ticks: Ticks) -> Ticks:
        """How many glitches are told up to each of `ticks`; these are accounted for."""
        counts = np.searchsorted(self.glitches, ticks, side="right")
        self.glitches = self.glitches[counts[-1] :].copy()
        return counts


@dataclass
class State:
    """All that a model remembers. The delivery of index 0 is shown, one of index 1 is to come.

    cycles: decided since reset; glitches: told until then. shown: the ticks of the deliveries.
    """

    now: int
    origin: int
    held: dict[str, int]
    uef: Pin
    data: Pin
    line: Any
    link: Any
    good_word: NDArray[np.uint64]
    shown: Ticks
    table: Table
    cycles: int = 0
    glitches: int = 0


class Model:
    """One position link as an engine by itself.

    Inputs: `uef`, `data`, `rst`, each 1 bit. Outputs: `clk`, `anf`, `delivery`, the fields of the
    configuration by their names, `radio_valid`, `radio_data`. No register can be poked.
    """

    _state: State

    def __init__(self, config: Config) -> None:
        self._config = config
        self._limits = limits(config)
        self._period = Fraction(1, config.clock_hz)
        self._inputs = [Port(name, 1, False, False, (name,)) for name in INPUTS]
        self._outputs = Outputs(config)
        self._fault_word = parts_of(config.invalid_word, config.word_bits)
        samples = range(config.window_bits + config.word_bits + 1)
        edge = config.rise if config.sampling_edge is Edge.RISING else config.fall
        self._samples = np.array([edge(n) for n in samples], np.int64)
        window = config.rise(config.earliest_clk - 1), config.rise(config.window_bits)
        last = config.decision_ticks - config.input_delay_ticks
        self._span = np.array([0, *window, last], np.int64)
        self._reset(0, 0, dict.fromkeys(INPUTS, 0))

    @property
    def now(self) -> int:
        return self._state.now

    @property
    def registers(self) -> tuple[str, ...]:
        """None."""
        return ()

    def poke(self, name: str, value: int) -> None:
        """Raises ValueError: there is no register."""
        poked({}, NAME, name, value)

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
        wanted = chosen(outputs, self._outputs.names, NAME)
        check(stimulus, NAME, self._period, self.now, until, self._inputs)
        start = self.now
        inputs = {name: Input(level, NO_TICKS) for name, level in self._state.held.items()}
        if until > start:
            for name, wave in stimulus.signals.items():
                inputs[name] = Input.of(wave, start, until)
        parts, held = [], {name: given.last for name, given in inputs.items()}
        for end, origin in stretches(inputs["rst"], start, until):
            parts.append(self._run(inputs, end))
            if origin is not None:
                self._reset(end, origin, held)
                if end < until:
                    parts.append(self._part(end, end))
        self._state.held, self._state.now = held, until
        return Trace(self._outputs.waves(parts, wanted), self._period, start, until)

    def _reset(self, end: int, origin: int, held: dict[str, int]) -> None:
        """All as at start: reset in the ticks end - 1 … origin - 1, of which the last is 0 again.

        The outputs are as at start from `end` on.
        """
        config = self._config
        line = np.zeros(1, LINE)
        line["word_bits"], line["guard_ticks"] = config.word_bits, config.guard_ticks
        self._state = State(
            now=origin,
            origin=origin,
            held=held,
            uef=Pin(Filter(config.filter_ticks)),
            data=Pin(Filter(config.filter_ticks)),
            line=line,
            link=np.zeros(1, LINK),
            good_word=self._fault_word.copy(),
            shown=np.array([end], np.int64),
            table=first_row(config),
        )

    def _run(self, inputs: dict[str, Input], end: int) -> Part:
        """Run up to `end`, without a reset on the way."""
        state, config, start = self._state, self._config, self._state.now
        pins = (("uef", state.uef, "level_u"), ("data", state.data, "level_d"))
        for name, pin, level in pins:
            given = inputs[name].part(start, end)
            if start == state.origin:
                pin.filter.level = given.level
                state.line[level] = given.level
            pin.take(given, start, end)
        first = state.origin + 1
        decided = -((first + config.decision_ticks - end) // config.cycle_ticks)
        if decided > state.cycles:
            self._decide(first + config.cycle_ticks * np.arange(state.cycles, decided))
            state.cycles = decided
        state.now = end
        return self._part(start, end)

    def _decide(self, begins: Ticks) -> None:
        """Read the cycles that begin in these ticks, decide on them, and add their deliveries."""
        state, config, n = self._state, self._config, begins.size
        found, words = np.empty(n, FOUND), np.zeros((n, self._fault_word.size), np.uint64)
        spans = begins[:, None] + self._span
        u, d = state.uef, state.data
        cycles(state.line, self._samples, begins, spans, u.edges, d.edges, words, found)
        for pin, at in ((u, "at_u"), (d, "at_d")):
            pin.edges = pin.edges[int(state.line[at][0]) :].copy()
            state.line[at] = 0
        found["causes"] |= complete(found) * objections(config, words)
        decisions = begins + config.decision_ticks
        glitches = state.glitches + u.told(decisions) + d.told(decisions)
        state.glitches = int(glitches[-1])
        room = np.empty((n, state.table.shape[1]), np.int64)
        state.table = np.concatenate([state.table, room])
        state.shown = np.concatenate([state.shown, begins + config.delivery_ticks])
        judge(
            self._limits,
            state.link,
            found,
            words,
            glitches,
            begins,
            state.good_word,
            self._fault_word,
            state.table[-n - 1 :],
        )

    def _part(self, start: int, end: int) -> Part:
        """The outputs of start ≤ tick < end; of the deliveries only the last shown is kept."""
        state = self._state
        first = max(int(np.searchsorted(state.shown, start, side="right")) - 1, 0)
        last = max(int(np.searchsorted(state.shown, end, side="left")), first + 1)
        part = Part(start, end, state.origin, state.shown[first:last], state.table[first:last])
        state.shown, state.table = state.shown[last - 1 :].copy(), state.table[last - 1 :].copy()
        return part
