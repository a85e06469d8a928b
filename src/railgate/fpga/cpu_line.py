"""What a CPU sends on the line that gateware.CpuLine takes, for boards on a desk."""

from __future__ import annotations

from struct import pack

from railgate.registers import WORD_BYTES
from railgate.registers.host.uart import framed

__all__ = ["command_frame", "time_frame"]


def time_frame(index: int, phase: int, boot: int) -> bytes:
    """The network's time, as of the frame's end: system cycle, ticks in it. boot: 16 bits, another
    number after each start of the channel."""
    return framed(pack("<HHII", 0, boot, index, phase))


def command_frame(command: bytes) -> bytes:
    """A command, as vital_output.host.encode makes it."""
    return framed(pack("<HH", 1, 0) + command + bytes(-len(command) % WORD_BYTES))
