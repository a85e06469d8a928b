"""The register map, declared once beside each function, and what is made of it (SYS-1)."""

from railgate.registers.block import Block, Gate, Group, Place
from railgate.registers.declaring import gather, identity
from railgate.registers.map import Map
from railgate.registers.register import WORD_BITS, WORD_BYTES, Access, Register, Values

__all__ = [
    "WORD_BITS",
    "WORD_BYTES",
    "Access",
    "Block",
    "Gate",
    "Group",
    "Map",
    "Place",
    "Register",
    "Values",
    "gather",
    "identity",
]
