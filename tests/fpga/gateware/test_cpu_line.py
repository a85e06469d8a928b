"""The line on which a CPU sends commands and the time: what comes of frames, good and bad ones."""

from fractions import Fraction
from struct import pack

import numpy as np
import pytest

from railgate.engines import Clock, Design, open_engine
from railgate.fpga.cpu_line import command_frame, time_frame
from railgate.fpga.gateware.cpu_line import CpuLine
from railgate.registers.host.uart import framed
from railgate.vital_output.gateware import Channel
from railgate.vital_output.host import encode
from railgate.waves import Trace, Waveform
from registers.host.desk import BIT_TICKS, sent
from vital_output.small import SMALL

COMMAND = encode(SMALL, 0, time=7, sequence=0xC0DB_0001, image=0b10, acknowledge=0b01)
"""Two of its bytes are those that a frame escapes."""


def taken(data: bytes, ready: int = 1) -> tuple[list[tuple[int, ...]], list[tuple[int, ...]]]:
    """What the line gives of these bytes: transfers (data, first, last), and updates of the time
    (index, phase, boot a tick later). ready: the channel takes a byte every so many ticks."""
    levels = [*[1] * 20, *sent(data), *[1] * 400]  # a line rests before it sends
    ticks = np.arange(len(levels))
    end = len(levels)
    clock = Clock(frequency_hz=Fraction(SMALL.clock_hz))
    signature = Channel(SMALL, 0).signature
    design = Design(
        name="cpu-line",
        component=lambda: CpuLine(SMALL, signature, BIT_TICKS),
        clocks=(clock,),
    )
    pins = Trace(
        {
            "rx": Waveform.of(ticks, levels, 1),
            "command.ready": Waveform.of(ticks, ticks % ready == 0, 1),
        },
        clock.period,
        0,
        end,
    )
    told = open_engine(design, "pysim").advance(end, pins)
    at = {name: wave.at(ticks) for name, wave in told.signals.items()}
    moves = np.flatnonzero(at["command.valid"] & (ticks % ready == 0))
    payload = at["command.payload"][moves]
    transfers = [(int(p) & 0xFF, int(p) >> 8 & 1, int(p) >> 9) for p in payload]
    updates = [
        (int(at["time.index"][t]), int(at["time.phase"][t]), int(at["boot"][t + 1]))
        for t in np.flatnonzero(at["time.valid"])
    ]
    return transfers, updates


def whole(command: bytes) -> list[tuple[int, ...]]:
    last = len(command) - 1
    return [(byte, at == 0, at == last) for at, byte in enumerate(command)]


@pytest.mark.parametrize("ready", [1, 3])
def test_a_command_comes_byte_by_byte_as_the_cpu_made_it(ready) -> None:
    data = command_frame(COMMAND)
    assert taken(data, ready) == (whole(COMMAND), [])
    assert taken(data * 2, ready) == (whole(COMMAND) * 2, [])


def test_the_time_comes_with_its_boot_number() -> None:
    data = time_frame(0xFFFF_FFFF, SMALL.cycle_ticks - 1, 0xC0DE) + time_frame(0, 5, 1)
    assert taken(data) == ([], [(0xFFFF_FFFF, SMALL.cycle_ticks - 1, 0xC0DE), (0, 5, 1)])


def test_one_follows_the_other() -> None:
    data = time_frame(7, 99, 3) + command_frame(COMMAND) + time_frame(8, 99, 3)
    assert taken(data) == (whole(COMMAND), [(7, 99, 3), (8, 99, 3)])


@pytest.mark.parametrize(
    "bad",
    [
        command_frame(COMMAND)[:-3] + b"\x55\xc0",
        command_frame(COMMAND + bytes(4)),
        command_frame(COMMAND[:-4]),
        time_frame(1, 2, 3)[:-3] + b"\x55\xc0",
        time_frame(1, 1 << 31, 3),
        framed(pack("<HHIII", 0, 3, 1, 2, 0)),
        framed(pack("<HHII", 2, 3, 1, 2)),
    ],
    ids=["spoilt", "long", "short", "spoilt time", "no phase", "long time", "unknown"],
)
def test_what_is_no_frame_of_either_kind_is_dropped(bad) -> None:
    assert taken(bad + command_frame(COMMAND)) == (whole(COMMAND), [])
