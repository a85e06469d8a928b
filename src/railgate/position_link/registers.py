"""The position link's registers: the delivery as of one tick, and the causes that came up.

Ref: requirements LNK-6, LNK-7.
"""

from __future__ import annotations

from railgate.field import Field
from railgate.position_link.spec import Cause, Config, Health, Status, cause_names
from railgate.registers import Access, Block, Gate, Group, Register, gather, identity

__all__ = ["registers"]

VERSION = 1


def registers(config: Config) -> Block:
    """What the bus sees of one position link; `<cause>_seen` stays set until a 1 is written."""
    delivery = Group(
        name="delivery",
        description="what the radio unit got last",
        registers=gather(
            config.fields,
            {"state": ["status", "health", "age", "causes"]},
            {"status": Status, "health": Health, "causes": Cause},
        ),
        gate=Gate.LATCH,
    )
    names = cause_names()
    seen = Register(
        name="seen",
        fields=tuple(Field(f"{name}_seen", 1, "since it was cleared") for name in names),
        access=Access.WRITE_ONE_TO_CLEAR,
        counters=tuple(f"{name}_cycles" for name in names),
    )
    return Block(
        name="position_link",
        description="the position system's word, its age, and the health of its line",
        entries=(*identity("LNK", VERSION, config.digest), seen, delivery),
    )
