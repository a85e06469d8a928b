"""What Yosys reads of a design."""

from __future__ import annotations

from hashlib import sha256
from typing import NamedTuple

__all__ = ["Sources"]


class Sources(NamedTuple):
    """rtlil: see netlist. verilog: of what is instantiated in it."""

    rtlil: str
    verilog: str = ""

    @property
    def digest(self) -> str:
        """In 12 hexadecimal digits."""
        return sha256(repr(tuple(self)).encode()).hexdigest()[:12]
