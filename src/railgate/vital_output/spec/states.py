"""States, codes and causes of the vital output, and the fields of its status."""

from __future__ import annotations

from enum import IntEnum
from functools import cache
from typing import TYPE_CHECKING

from railgate.field import Field

if TYPE_CHECKING:
    from railgate.vital_output.spec.config import Config

__all__ = ["CAUSES", "Cause", "Code", "State", "TestPhase", "status_fields"]

STATE_BITS = 3


class State(IntEnum):
    """What one output does (DRV-8 … DRV-12); TEST is a pulse train without the peer (DRV-18)."""

    IDLE = 0
    PRE_DRIVE = 1
    DRIVE = 2
    WAIT = 3
    TEST = 4
    HANDSHAKE_ALARM = 5
    FEEDBACK_ALARM = 6


class Code(IntEnum):
    """What the peer is told of an output's state: OFF is IDLE, WAIT or TEST, ALARM either one."""

    OFF = 0
    PRE_DRIVE = 1
    DRIVE = 2
    ALARM = 3


class TestPhase(IntEnum):
    """How far the test of the shut-off paths has come in one FPGA (DRV-18).

    REQUESTED is DONE, and another test is wanted when the outputs are quiet.
    """

    __test__ = False  # no test case of pytest's

    WANTED = 0
    RUNNING = 1
    DONE = 2
    REQUESTED = 3


class Cause(IntEnum):
    """What went wrong, each with a counter `<name>_count`; the first one since the last
    acknowledgement is latched. Of several in one tick the lowest counts as first."""

    NONE = 0
    FORMAT = 1
    """A frame of another length, with bits set that belong to no output, or begun anew."""
    TIME = 2
    """A frame while the FPGA's own time is not trusted."""
    COMPARATOR = 3
    """Step 2: the comparator has not seen that the CRC with the mask differs."""
    CORRUPTION = 4
    """No board and cycle tried gives the frame's CRC."""
    DELAY = 5
    """A frame of another cycle, beyond the margin."""
    MASQUERADE = 6
    """A frame for the other board."""
    REPETITION = 7
    RESEQUENCE = 8
    INSERTION = 9
    """A sequence number further ahead than lost frames explain."""
    FORWARD = 10
    """A frame that the peer forwarded does not pass here."""
    SKEW = 11
    """The other CPU's frame has not come within τ0."""
    MISMATCH = 12
    """The two CPUs' frames differ."""
    LINK_CHECK = 13
    """A message with a wrong CRC, or a start bit that is none."""
    LINK_DIGEST = 14
    """A message of an FPGA with another configuration."""
    LINK_SEQUENCE = 15
    """A message out of sequence."""
    LINK_LOST = 16
    """No message for too long."""
    OSCILLATOR = 17
    """The peer's clock, measured with ours, is off its tolerance."""
    TIME_JUMP = 18
    """The network's time is off ours by more than the margin."""
    LIFE_OUT = 19
    """The last command's life has come to its end."""
    HANDSHAKE_ALARM = 20
    FEEDBACK_ALARM = 21
    LATCHED = 22
    """A second frame was rejected within the error interval."""
    UPSET = 23
    """A hardened state or counter was not what it can be."""


CAUSES = tuple(cause for cause in Cause if cause)


@cache
def status_fields(config: Config) -> tuple[Field, ...]:
    """The fields of a channel's status, each an output of that name (NET-5)."""
    n, count = config.outputs, config.count_bits
    return (
        Field("index", 32, "of the system cycle, by the channel's own time", "cycles"),
        Field("trusted", 1, "frames can be accepted: its time agrees with the network's"),
        Field("sequence", 32, "of the frame last accepted"),
        Field("life", 4, "cycles that the image still has", "cycles"),
        Field("image", n, "commands that drive, bit i of output i"),
        Field("acknowledge", n, "of the frame last stored", start=(1 << n) - 1),
        Field("states", STATE_BITS * n, "of output i in bits 3i to 3i + 2, see State"),
        Field("blocked", n, "outputs that wait for a live 0 after a start", start=(1 << n) - 1),
        Field("test_phase", 2, "of the shut-off paths' test, see TestPhase"),
        Field("linked", 1, "messages of the peer come"),
        Field("drifting", 1, "the peer's clock is off its tolerance"),
        Field("latched", 1, "frames were rejected too often (DRV-15)"),
        Field("first_cause", 5, "the first since the last acknowledgement, see Cause"),
        Field("first_output", 6, "of that cause, if an alarm: the lowest such output, else 0"),
        Field("accepted_count", count, "frames accepted, modulo its width"),
        Field("start_count", count, "frames that began a sequence, modulo its width"),
        Field("lost_count", count, "frames missing between accepted ones, modulo its width"),
        Field("passed_count", count, "votes passed here, modulo its width"),
        Field("stored_count", count, "images stored, modulo its width"),
        *(
            Field(f"{cause.name.lower()}_count", count, "modulo its width, see Cause")
            for cause in CAUSES
        ),
    )
