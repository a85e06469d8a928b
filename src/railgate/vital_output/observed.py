"""One FPGA in a run: what came to its command port, what its registers tell, and when."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from railgate.engines import Clock
from railgate.engines.signals import parts
from railgate.vital_output.plant.edges import Edges
from railgate.vital_output.spec import Config, unpack
from railgate.waves import Trace, Waveform
from railgate.waves.waveform import Ticks

__all__ = ["Frame", "Observed"]

STATE_BITS = 3


@dataclass(frozen=True, kw_only=True)
class Frame:
    """A frame as it came, right or wrong.

    tick: in which its last byte was transferred, of the FPGA's clock. at: the femtosecond with
    which that tick begins. values: its fields by name; None where it has not their length.
    """

    tick: int
    at: int
    values: Mapping[str, int] | None

    @property
    def image(self) -> int:
        """What it commands, nothing if it is wrong."""
        return self.values["image"] if self.values else 0


@dataclass(frozen=True)
class Observed:
    """FPGA 1 or 2 of a Loop's run.

    clock: the FPGA's. trace: the run from tick 0 on, in femtoseconds, with the inputs and all
    fields of the FPGA and its `command.ready`. What a reset does to a register is no change of it.
    """

    config: Config
    clock: Clock
    trace: Trace
    fpga: int

    def wave(self, name: str) -> Waveform:
        """A signal of this FPGA."""
        return self.trace[f"fpga_{self.fpga}.{name}"]

    @cached_property
    def resets(self) -> Ticks:
        """The femtoseconds in which a reset begins."""
        return self._reset.rising()

    @property
    def _reset(self) -> Waveform:
        return self.trace[f"fpga_{self.fpga}_rst"]

    def changes(self, name: str) -> Iterator[tuple[int, int, int]]:
        """Femtosecond, old and new value of each change of a field of at most 64 bits."""
        return self._changes(self.wave(name))

    def _changes(self, wave: Waveform) -> Iterator[tuple[int, int, int]]:
        by_reset = self._reset.at(wave.ticks[1:] - 1)
        values = wave.values.tolist()
        for i, (tick, reset) in enumerate(zip(wave.ticks[1:].tolist(), by_reset, strict=True)):
            if not reset:
                yield tick, values[i], values[i + 1]

    def counted(self, name: str) -> list[tuple[int, int]]:
        """Femtosecond and increment of each event that the counter `<name>_count` has counted."""
        return self._counts[name]

    @cached_property
    def _counts(self) -> Mapping[str, list[tuple[int, int]]]:
        modulus = 1 << self.config.count_bits
        return {
            field.name.removesuffix("_count"): [
                (tick, (new - old) % modulus) for tick, old, new in self.changes(field.name)
            ]
            for field in self.config.fields
            if field.name.endswith("_count")
        }

    def total(self, name: str) -> int:
        """How many events the counter has counted in all of the run, over resets."""
        return sum(step for _, step in self.counted(name))

    def state(self, output: int) -> Waveform:
        """The state of an output, over resets."""
        low, width = STATE_BITS * output, STATE_BITS * self.config.outputs
        held = [
            (self.wave(name), offset - low)
            for name, bits, offset in parts("states", width)
            if offset < low + STATE_BITS and low < offset + bits
        ]
        ticks = np.unique(np.concatenate([wave.ticks for wave, _ in held]))
        values = np.zeros(ticks.size, np.uint64)
        for wave, above in held:
            part = wave.at(ticks).astype(np.uint64)
            values |= part << np.uint64(above) if above > 0 else part >> np.uint64(-above)
        return Waveform.of(ticks, values & np.uint64((1 << STATE_BITS) - 1), STATE_BITS)

    def transitions(self, output: int) -> Iterator[tuple[int, int, int]]:
        """Femtosecond, old and new state of each change of an output's state."""
        return self._changes(self.state(output))

    @cached_property
    def edges(self) -> Edges:
        return Edges(self.clock)

    @cached_property
    def frames(self) -> tuple[Frame, ...]:
        """All whose last byte was transferred, in order."""
        there = self._transfers()
        words = self._sampled("command.payload").at(there)
        first, last = (np.flatnonzero(words >> bit & 1) for bit in (8, 9))
        begins = np.append(0, first)[np.searchsorted(first, last, side="right")]
        return tuple(
            Frame(tick=tick, at=at, values=self._fields(words[begin : end + 1].tolist()))
            for begin, end, tick, at in zip(
                begins.tolist(),
                last.tolist(),
                there[last].tolist(),
                self.edges.begin(there[last]).tolist(),
                strict=True,
            )
        )

    def _transfers(self) -> Ticks:
        """The ticks of the clock in which a byte was transferred."""
        names = ("command.valid", "command.ready", "stopped")
        waves = [*map(self._sampled, names), self.edges.sampled(self._reset)]
        ticks = np.unique(np.concatenate([wave.ticks for wave in waves]))
        valid, ready, stopped, reset = (wave.at(ticks) != 0 for wave in waves)
        counts = np.diff(np.append(ticks, self.edges.count(self.trace.end)))
        counts *= valid & ready & ~stopped & ~reset
        begun = ticks - (np.cumsum(counts) - counts)
        there: Ticks = np.repeat(begun, counts) + np.arange(counts.sum())
        return there

    def _sampled(self, name: str) -> Waveform:
        return self.edges.sampled(self.wave(name))

    def _fields(self, words: list[int]) -> Mapping[str, int] | None:
        layout = self.config.layout
        if len(words) != layout.frame_bytes:
            return None
        return unpack(layout.frame, int.from_bytes([word & 0xFF for word in words], "big"))

    def judged(self, at: int) -> Frame:
        """The frame of whose verdict a register tells that changes in this femtosecond."""
        last = int(self.edges.during(at)) - 1 - self.config.check_ticks
        return self.frames[bisect_right(self.frames, last, key=lambda frame: frame.tick) - 1]

    @cached_property
    def stores(self) -> tuple[tuple[int, Frame], ...]:
        """Femtosecond in which a register first tells that a frame was stored, and the frame: the
        one last accepted before."""
        accepted = [at for at, _ in self.counted("accepted")]
        found = []
        for at, _ in self.counted("stored"):
            before = accepted[bisect_left(accepted, at) - 1]
            found.append((at, self.judged(before)))
        return tuple(found)
