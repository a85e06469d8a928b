"""A run's inputs as an FPGA samples them: frames and updates of time."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from railgate.vital_output.plant.cpu import Command
from railgate.vital_output.plant.edges import Edges
from railgate.vital_output.plant.faults import fault
from railgate.vital_output.plant.scenario import Scenario
from railgate.vital_output.spec import Config, unpack
from railgate.waves import Trace
from vital_output.small import SMALL

CYCLES = 12
SECONDS = CYCLES * SMALL.cycle_s
PHASE = 2 * SMALL.margin_ticks


@dataclass(frozen=True)
class Received:
    """A frame: the tick of its last byte, its fields, and the (board, time) that give its CRC."""

    tick: int
    sequence: int
    image: int
    acknowledge: int
    made_for: tuple[int, int] | None


def scenario(*faults: str, **settings: Any) -> Scenario:
    told = {"commands": (Command(start_s=Fraction(0), image=1),), "seconds": SECONDS}
    return Scenario(**{**told, **settings}, faults=tuple(fault(text) for text in faults))


def edges(told: Scenario, fpga: int) -> Edges:
    return Edges(told.clocks(SMALL)[fpga - 1])


def sampled(told: Scenario, inputs: Trace, fpga: int, *names: str) -> list[list[int]]:
    """What the edges of an FPGA's clock find at the end of each tick."""
    clock = edges(told, fpga)
    ticks = clock.begin(np.arange(1, clock.count(inputs.end))) - 1
    return [inputs[f"fpga_{fpga}.{name}"].at(ticks).tolist() for name in names]


def frames(told: Scenario, fpga: int, config: Config = SMALL) -> list[Received]:
    """What comes to an FPGA that is ever ready."""
    inputs = told.controls(config)
    payload, valid = sampled(told, inputs, fpga, "command.payload", "command.valid")
    data, found = b"", []
    for tick, byte in enumerate(payload):
        if not valid[tick]:
            assert byte == 0
            continue
        assert (byte >> 8 & 1) == (not data)
        data += bytes([byte & 0xFF])
        if byte >> 9:
            found.append(received(data, tick, config))
            data = b""
    return found


def received(data: bytes, tick: int, config: Config) -> Received:
    assert len(data) == config.layout.frame_bytes
    fields = unpack(config.layout.frame, int.from_bytes(data, "big"))
    crc = fields.pop("crc")
    near = tick // config.cycle_ticks
    made_for = [
        (board, time)
        for board in (0, 1)
        for time in range(near - 4, near + 5)
        if config.layout.crc(config.boards[board], time, fields) == crc
    ]
    assert len(made_for) <= 1
    return Received(tick, *fields.values(), made_for[0] if made_for else None)
