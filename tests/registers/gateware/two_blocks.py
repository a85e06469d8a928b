"""A map of two blocks for bridges to reach: words to write, bits to see once, and holes."""

from __future__ import annotations

from railgate.field import Field
from railgate.registers import Access, Block, Map, Register, identity

__all__ = ["IDENTITY", "MAP", "SEEN", "TRIGGER", "WORDS", "block"]

IDENTITY = (b"\x01TST", b"\xbc\x0a\0\0")
"""The first two words of a block."""
SEEN = 0x8
"""Bits that were set since they were read."""
TRIGGER = 0xC
"""Not to be read."""
WORDS = range(0x10, 0x20, 4)
"""Words to read and write."""


def block(name: str) -> Block:
    """`<name>_events` sets the bits. It is full: it ends with its last word."""
    seen = Register(
        name=f"{name}_seen",
        fields=(Field(f"{name}_events", 8, "were seen"),),
        access=Access.READ_TO_CLEAR,
    )
    go = Register(
        name=f"{name}_go", fields=(Field(f"{name}_starts", 4, "starts"),), access=Access.TRIGGER
    )
    words = (
        Register(
            name=f"{name}_word_{offset}",
            fields=(Field(f"{name}_data_{offset}", 32, "anything"),),
            access=Access.READ_WRITE,
        )
        for offset in WORDS
    )
    entries = (*identity("TST", 1, 0xABC), seen, go, *words)
    return Block(name=name, description="words", entries=entries)


MAP = Map(
    name="judged",
    description="two blocks and a hole",
    blocks={0: block("one"), 0x40: block("two")},
)
