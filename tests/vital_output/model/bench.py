"""One channel's surroundings, drawn tick by tick: time, CPU, peer, pins."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from railgate.vital_output.model import ChannelModel
from railgate.vital_output.spec import Config, State, pack
from railgate.waves import Trace, Waveform
from vital_output.small import SMALL

__all__ = ["Bench", "changes", "states"]

PEER = {"boot": 7, "test": 0, "codes": 0, "carries": 0, "passed": 0}
FRAME = {"sequence": 0, "image": 0, "acknowledge": 0, "frame_crc": 0}


@dataclass
class Bench:
    """What the inputs of a channel are. Later calls draw over earlier ones in the same ticks."""

    config: Config = SMALL
    board: int = 0
    drawn: dict[str, dict[int, int]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        outputs = self.config.outputs
        phase_bits = (self.config.cycle_ticks - 1).bit_length()
        self.widths = {"command.payload": 10, "time.index": 32, "time.phase": phase_bits}
        self.widths |= {"boot": 16, "pulse_feedback": outputs, "contact": outputs}
        self.set("link_rx", 0, 1)

    def set(self, name: str, tick: int, value: int) -> None:
        """An input is this from the tick on."""
        self.drawn.setdefault(name, {0: 0})[tick] = value

    def update(self, tick: int, index: int, phase: int) -> None:
        for name, value in (("index", index), ("phase", phase)):
            self.set(f"time.{name}", tick, value)
        self.set("time.valid", tick, 1)
        self.set("time.valid", tick + 1, 0)

    def trust(self, index: int, phase: int) -> None:
        """In tick 10 time is seated, in tick 20 it is trusted: phase[k] = phase + k - 10."""
        self.update(10, index, phase)
        self.update(20, index, phase + 10)

    def data(self, tick: int, bytes_: list[int]) -> int:
        """Bytes with their first and last, one a tick; returns the last one's tick."""
        for place, byte in enumerate(bytes_):
            self.set("command.payload", tick + place, byte)
            self.set("command.valid", tick + place, 1)
        self.set("command.valid", tick + len(bytes_), 0)
        return tick + len(bytes_) - 1

    def frame(self, tick: int, index: int, board: int | None = None, **fields: int) -> int:
        """A frame, for this board and cycle; returns its last byte's tick."""
        board = self.board if board is None else board
        return self.data(tick, framed(self.config, board, index, **fields))

    def message(self, tick: int, number: int, board: int | None = None, **fields: int) -> int:
        """A message of the peer whose start bit falls in this tick; returns its verdict's tick."""
        config, layout = self.config, self.config.layout
        values = {**PEER, **FRAME, "digest": config.digest, **fields, "number": number % 256}
        board = 1 - self.board if board is None else board
        body = pack(layout.message[:-1], values)
        count = layout.message_bits - 1
        crc = layout.message_check(config.boards[board]).of(body, count - 32)
        bits = [0, *(((body << 32 | crc) >> place & 1) for place in reversed(range(count))), 1]
        for place, bit in enumerate(bits):
            self.set("link_rx", tick + place * config.bit_ticks, bit)
        return tick + 3 + count * config.bit_ticks + config.bit_ticks // 2 + 1

    def peer(self, first: int, until: int, *changes_: tuple[int, dict[str, int]]) -> None:
        """Messages from tick `first` on, as the peer sends them; their fields from a tick on."""
        fields: dict[str, int] = {}
        steps = sorted(changes_, key=lambda change: change[0])
        for number, tick in enumerate(range(first, until, self.config.link_period_ticks)):
            while steps and steps[0][0] <= tick:
                fields |= steps.pop(0)[1]
            self.message(tick, number, **fields)

    def train(self, outputs: int, rise: int, until: int) -> None:
        """Pulse trains come back from these outputs, the first rise in this tick."""
        config = self.config
        for tick in range(rise, until, config.period_ticks):
            self.set("pulse_feedback", tick, outputs)
            self.set("pulse_feedback", tick + config.half_period_ticks, 0)

    def stimulus(self, end: int) -> Trace:
        waves = {}
        for name, of in self.drawn.items():
            ticks = sorted(tick for tick in of if tick < end)
            values = [of[tick] for tick in ticks]
            waves[name] = Waveform.of(ticks, values, self.widths.get(name, 1))
        return Trace(waves, Fraction(1, self.config.clock_hz), 0, end)

    def run(self, end: int, outputs: Collection[str] | None = None) -> Trace:
        model = ChannelModel(self.config, self.board)
        return model.advance(end, self.stimulus(end), outputs)


def framed(config: Config, board: int, index: int, **fields: int) -> list[int]:
    """The payloads of a frame for one of the boards: data, first and last."""
    layout = config.layout
    values = {"sequence": 0, "image": 0, "acknowledge": 0, **fields}
    values.setdefault("crc", layout.crc(config.boards[board], index, values))
    data: list[int] = list(pack(layout.frame, values).to_bytes(layout.frame_bytes, "big"))
    data[0] |= 1 << 8
    data[-1] |= 1 << 9
    return data


def changes(run: Trace, name: str) -> list[tuple[int, int]]:
    """Tick and value of each change of an output."""
    wave = run[name]
    return list(zip(wave.ticks.tolist(), wave.values.tolist(), strict=True))[1:]


def states(run: Trace, output: int = 0) -> list[tuple[int, Any]]:
    """Tick and state of each change of one output's state."""
    found = [(0, State.IDLE)]
    for tick, value in changes(run, "states"):
        state = State(value >> 3 * output & 7)
        if state != found[-1][1]:
            found.append((tick, state))
    return found[1:]
