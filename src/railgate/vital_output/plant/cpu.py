"""The two CPUs: which frames they send, and when each byte is at an FPGA (DRV-1)."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from railgate.bounds import require
from railgate.vital_output.host import encoded
from railgate.vital_output.plant.edges import Edges, femtoseconds, multiples
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


NOTHING = Command(start_s=Fraction(0), image=0)
"""What holds before the first."""


@dataclass(frozen=True, kw_only=True)
class Frame:
    """One frame on its way to an FPGA.

    cycle: of the run, in which it is made. sent: when it comes, femtoseconds. board: 0 or 1, the
    FPGA that it is made for. time: the index in its CRC. inverted: the bits, of the whole frame as
    one number, that are inverted on the way. instead: what comes, if it is not what is encoded.
    """

    cycle: int
    sent: int
    board: int
    time: int
    sequence: int
    image: int
    acknowledge: int
    inverted: int = 0
    instead: bytes | None = None


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
        begins = [command.start_s / config.cycle_s for command in commands]
        due = [
            multiples(config.cycle_s, phase + skew, cycles) for skew in (Fraction(0), self.skew_s)
        ]
        for cycle in range(self.first_cycle, cycles):
            at = bisect_right(begins, cycle)
            command = commands[at - 1] if at else NOTHING
            for board in range(2):
                sent[board].append(
                    Frame(
                        cycle=cycle,
                        sent=max(due[board][cycle], 0) + jitter[board][cycle],
                        board=board,
                        time=first_index + cycle,
                        sequence=self.first_sequence + cycle - self.first_cycle,
                        image=command.image,
                        acknowledge=command.acknowledge,
                    )
                )
        return sent


def stream(config: Config, edges: Edges, frames: Sequence[Frame], end: int) -> dict[str, Waveform]:
    """An FPGA's `command.payload` and `command.valid` below the femtosecond `end`.

    A byte a tick, from the first tick on that begins not before the frame is sent; one that comes
    while the channel still checks the frame before waits for it.
    """
    ordered = sorted((each for each in frames if each.sent < end), key=lambda each: each.sent)
    sent = _sent(config, ordered)
    sizes = np.array([len(data) for data in sent], np.int64)
    first, free = edges.first([frame.sent for frame in ordered]).tolist(), 0
    for n, size in enumerate(sizes.tolist()):
        first[n] = max(first[n], free)
        free = first[n] + size - 1 + config.check_ticks
    # Behind each frame stands a byte that is none.
    stops = np.cumsum(sizes + 1) - 1
    starts = stops - sizes
    told = np.frombuffer(b"\0".join([*sent, b""]), np.uint8).astype(np.uint64)
    told[starts] |= FIRST
    told[stops - 1] |= LAST
    valid = np.ones(told.size, np.uint64)
    valid[stops] = 0
    at = np.repeat(np.array(first, np.int64) - starts, sizes + 1) + np.arange(told.size)
    return {
        name: edges.wave(np.append(0, at), np.append(np.uint64(0), values), width, end)
        for name, values, width in (
            ("command.payload", told, PAYLOAD_BITS),
            ("command.valid", valid, 1),
        )
    }


def _sent(config: Config, frames: Sequence[Frame]) -> list[bytes]:
    """The bytes of each frame as they come."""
    names = ("board", "time", "sequence", "image", "acknowledge")
    made = encoded(config, *([getattr(frame, name) for frame in frames] for name in names))
    sent = [row.tobytes() for row in made]
    for n, frame in enumerate(frames):
        if frame.inverted:
            whole = int.from_bytes(sent[n], "big") ^ frame.inverted
            sent[n] = whole.to_bytes(len(sent[n]), "big")
        if frame.instead is not None:
            sent[n] = frame.instead
    return sent
