"""The registers of one channel of the vital output: its status, the causes that came up, the test.

Nothing that a bus writes can make an output drive. Two registers can be written at all: `seen`,
whose bits go nowhere but back to the bus, and `test`, which asks for the test of the shut-off paths
(DRV-18): in it a channel pulses alone, which never holds the relay, and only while its output is
at rest. Commands come over the channel's own stream alone, with their CRC.
"""

from __future__ import annotations

from railgate.field import Field
from railgate.registers import Access, Block, Gate, Group, Register, Values, gather, identity
from railgate.vital_output.spec import CAUSES, Cause, Config, State, TestPhase

__all__ = ["registers"]

VERSION = 1

STATE = ("trusted", "linked", "drifting", "latched", "test_phase", "life", "first_cause")
VALUES: dict[str, Values] = {"states": State, "test_phase": TestPhase, "first_cause": Cause}


def registers(config: Config) -> Block:
    """What the bus sees of one channel; `<cause>_seen` stays set until a 1 is written."""
    status = Group(
        name="status",
        description="the channel's state and its counters",
        registers=gather(config.fields, {"state": [*STATE, "first_output"]}, VALUES),
        gate=Gate.LATCH,
    )
    names = [cause.name.lower() for cause in CAUSES]
    seen = Register(
        name="seen",
        fields=tuple(Field(f"{name}_seen", 1, "since it was cleared") for name in names),
        access=Access.WRITE_ONE_TO_CLEAR,
        counters=tuple(f"{name}_count" for name in names),
    )
    test = Field("test", 1, "asks for a test of the shut-off paths")
    return Block(
        name="vital_output",
        description="votes both CPUs' commands and drives one half of each output",
        entries=(
            *identity("DRV", VERSION, config.digest),
            seen,
            Register(name="control", fields=(test,), access=Access.TRIGGER),
            status,
        ),
    )
