"""The two CPUs: which frames they send, and when each byte is at an FPGA (DRV-1)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from railgate.bounds import require
from railgate.vital_output.host import encode
from railgate.vital_output.plant.edges import Edges, femtoseconds
from railgate.vital_output.spec import Config
from railgate.waves import Waveform

__all__ = ["Command", "Cpus", "Frame", "stream"]

PAYLOAD_BITS = 10
FIRST, LAST = np.uint64(1 << 8), np.uint64(1 << 9)


@dataclass(frozen=True, kw_only=True)
class Command:
    """From `start_s` until the next one both CPUs command this; bit i is output i's."""

    start_s: Fraction
    image: int
    acknowledge: int = 0


@dataclass(frozen=True, kw_only=True)
class Frame:
    """One frame on its way to an FPGA.

    cycle: of the run, in which it is made. sent: when it comes, femtoseconds. board: 0 or 1, the
    FPGA that it is made for. time: the index in its CRC. inverted: the bits, of the whole frame as
    one number, that are inverted on the way.
    """

    cycle: int
    sent: int
    board: int
    time: int
    sequence: int
    image: int
    acknowledge: int
    inverted: int = 0

    def encoded(self, config: Config) -> bytes:
        """As it comes."""
        made = encode(config, self.board, self.time, self.sequence, self.image, self.acknowledge)
        return (int.from_bytes(made, "big") ^ self.inverted).to_bytes(len(made), "big")


@dataclass(frozen=True, kw_only=True)
class Cpus:
    """The schedule of the pair. Raises ValueError.

    Each cycle both send a frame with the command that holds when the cycle begins. phase_s: from
    the cycle's beginning until then; None: twice the margin. skew_s: by so much CPU 2's come later,
    less than 0: earlier. jitter_s: each frame comes up to so much later, at random. first_cycle: of
    the run, the first with a frame; an FPGA's time is trusted from the second update on.
    first_sequence: its number, one more in each further cycle.
    """

    phase_s: Fraction | None = None
    skew_s: Fraction = Fraction(0)
    jitter_s: Fraction = Fraction(0)
    first_cycle: int = 2
    first_sequence: int = 0

    def __post_init__(self) -> None:
        require(
            self,
            ("skew_s", -10, 10),
            ("jitter_s", 0, 10),
            ("first_cycle", 0, 1 << 32),
            ("first_sequence", 0, (1 << 32) - 1),
        )
        if self.phase_s is not None:
            require(self, ("phase_s", 0, 10))

    def frames(
        self,
        config: Config,
        commands: Sequence[Command],
        first_index: int,
        cycles: int,
        random: np.random.Generator,
    ) -> tuple[list[Frame], list[Frame]]:
        """What CPU 1 and CPU 2 send in so many cycles, the first one of index `first_index`."""
        phase = 2 * config.margin_s if self.phase_s is None else self.phase_s
        jitter = random.integers(0, 1 + femtoseconds(self.jitter_s), (2, cycles)).tolist()
        sent: tuple[list[Frame], list[Frame]] = ([], [])
        for cycle in range(self.first_cycle, cycles):
            begin = cycle * config.cycle_s
            command = _command(commands, begin)
            for board, skew in enumerate((Fraction(0), self.skew_s)):
                due = max(femtoseconds(begin + phase + skew), 0)
                sent[board].append(
                    Frame(
                        cycle=cycle,
                        sent=due + jitter[board][cycle],
                        board=board,
                        time=first_index + cycle,
                        sequence=self.first_sequence + cycle - self.first_cycle,
                        image=command.image,
                        acknowledge=command.acknowledge,
                    )
                )
        return sent


def _command(commands: Sequence[Command], time_s: Fraction) -> Command:
    """The one that holds at a time; all 0 before the first."""
    held = Command(start_s=Fraction(0), image=0)
    for command in commands:
        if command.start_s > time_s:
            break
        held = command
    return held


def stream(config: Config, edges: Edges, frames: Sequence[Frame], end: int) -> dict[str, Waveform]:
    """An FPGA's `command.payload` and `command.valid` below the femtosecond `end`.

    A byte a tick, from the first tick on that begins not before the frame is sent; one that comes
    while the channel still checks the frame before waits for it.
    """
    ordered = sorted((each for each in frames if each.sent < end), key=lambda each: each.sent)
    due = edges.first(np.array([frame.sent for frame in ordered], np.int64)).tolist()
    ticks, values, valid = (
        [np.zeros(1, np.int64)],
        [np.zeros(1, np.uint64)],
        [np.zeros(1, np.bool_)],
    )
    free = 0
    for frame, tick in zip(ordered, due, strict=True):
        data = np.frombuffer(frame.encoded(config), np.uint8).astype(np.uint64)
        data[0] |= FIRST
        data[-1] |= LAST
        first = max(tick, free)
        free = first + data.size - 1 + config.check_ticks
        ticks.append(first + np.arange(data.size + 1))
        values.append(np.append(data, np.uint64(0)))
        valid.append(np.arange(data.size + 1) < data.size)
    at = np.concatenate(ticks)
    return {
        "command.payload": edges.wave(at, np.concatenate(values), PAYLOAD_BITS, end),
        "command.valid": edges.wave(at, np.concatenate(valid), 1, end),
    }
