"""What a fault works on: frames, time and wires of a run that is still being planned."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from railgate.vital_output.plant.cpu import Frame
from railgate.vital_output.plant.edges import Edges
from railgate.vital_output.plant.relay import DEFECTS, FEEDBACK, combined
from railgate.vital_output.plant.time import Update
from railgate.vital_output.spec import Config
from railgate.waves import Waveform
from railgate.waves.waveform import Ticks

__all__ = ["Draft", "Effect", "Hit", "wires"]

DISTURBANCES = ("flip", "low", "high")


def wires(config: Config) -> dict[str, int]:
    """The inputs of a Loop that only faults and tests change, and the width of each."""
    plain = [f"fpga_{c}{name}" for c in (1, 2) for name in (".test", ".stopped", "_rst")]
    plain += [f"line_{c}.{name}" for c in (1, 2) for name in DISTURBANCES]
    defects = [f"relay.{name}" for name in (*DEFECTS, *FEEDBACK)]
    return dict.fromkeys(plain, 1) | dict.fromkeys(defects, config.outputs)


@dataclass(frozen=True, kw_only=True)
class Hit:
    """Where one fault hits: these cycles, and the femtoseconds start ≤ k < stop; start = stop is
    the one moment."""

    kind: str
    value: int | None
    cycles: range
    start: int
    stop: int
    random: np.random.Generator

    def given(self, default: int, low: int, high: int) -> int:
        """The fault's value. Raises ValueError outside low … high."""
        value = default if self.value is None else self.value
        if not low <= value <= high:
            raise ValueError(
                f"the value of {self.kind} must be between {low} and {high}, not {value}"
            )
        return value


@dataclass
class Draft:
    """A run whose frames, updates of time and wires still change.

    edges: of the clocks of FPGA 1 and FPGA 2. end: of the run, femtoseconds. frames, updates: what
    comes to FPGA 1 and FPGA 2. starts: the ticks of each one's resets.
    """

    config: Config
    edges: tuple[Edges, Edges]
    end: int
    frames: list[list[Frame]]
    updates: list[list[Update]]
    starts: tuple[list[int], list[int]] = field(default_factory=lambda: ([], []))
    held: dict[tuple[str, int], list[tuple[Ticks, Ticks]]] = field(default_factory=dict)

    def hold(self, wire: str, starts: ArrayLike, stops: ArrayLike, bit: int = 0) -> None:
        """That bit is 1 in each start ≤ k < stop; of flips that overlap two cancel out."""
        spans = (np.atleast_1d(starts).astype(np.int64), np.atleast_1d(stops).astype(np.int64))
        self.held.setdefault((wire, bit), []).append(spans)

    def hold_ticks(self, fpga: int, name: str, start: int, stop: int) -> int:
        """An input of FPGA 1 or 2 is 1 in the ticks that begin within these femtoseconds, in one at
        least; returns the first of them."""
        edges = self.edges[fpga - 1]
        first, behind = edges.first([start, stop]).tolist()
        begin, end = edges.begin([first, max(behind, first + 1)])
        self.hold(f"fpga_{fpga}{name}", begin, end)
        return int(first)

    def wires(self) -> dict[str, Waveform]:
        """All of `wires`, from the start on."""
        return {
            name: combined([self._wave(name, bit) for bit in range(width)])
            for name, width in wires(self.config).items()
        }

    def _wave(self, wire: str, bit: int) -> Waveform:
        if (wire, bit) not in self.held:
            return Waveform.of([0], [0])
        starts, stops = (np.concatenate(each) for each in zip(*self.held[wire, bit], strict=True))
        times = np.concatenate([starts, stops])
        order = np.argsort(times, kind="stable")
        held = np.cumsum(np.where(order < starts.size, 1, -1))
        level = held & 1 if wire.endswith("flip") else held > 0
        inside = np.searchsorted(times[order], self.end)
        return Waveform.of(np.append(0, times[order][:inside]), np.append(0, level[:inside]))


Effect = Callable[[Draft, Hit], None]
