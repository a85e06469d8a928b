"""A block's registers by name, on any bus."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from railgate.registers.block import Block
from railgate.registers.host.bus import Bus
from railgate.registers.register import Register

__all__ = ["Registers"]


class Registers:
    """One block at its base address. All may raise BusError, and ValueError for a wrong name."""

    def __init__(self, bus: Bus, block: Block, base: int = 0) -> None:
        self._bus = bus
        self.base = base
        self.block = block

    def read(self, name: str, *, again: bool = False) -> dict[str, int]:
        """The fields of a register, or of all of a group in one burst, by name; of a group that is
        the gate. again: read where it is none."""
        place = self.block.place(name)
        alone = place.group is None or name != place.group.name
        registers = (place.register,) if place.group is None or alone else place.group.registers
        offset = place.offset
        if again:
            if place.again is None:
                raise ValueError(f"{name} is in no group, it cannot be read again")
            offset = place.again
        count = sum(register.words for register in registers)
        return dict(_fields(registers, self._bus.read(self.base + offset, count)))

    def write(self, name: str, **fields: int) -> None:
        """A register; fields that are not named are 0, which to trigger or clear does nothing."""
        place = self.block.place(name)
        self._bus.write(self.base + place.offset, place.register.pack(fields))

    def require_same(self) -> None:
        """Raises ValueError unless the block on the bus is this one: its function, the version of
        its registers and its configuration (SYS-5)."""
        for register in self.block.registers[:IDENTITY]:
            found = self.read(register.name)
            for field in register.fields:
                if found[field.name] != field.start:
                    raise ValueError(
                        f"{field.name} of the {self.block.name} at {self.base:#x} must be "
                        f"{field.start:#x}, not {found[field.name]:#x}"
                    )


IDENTITY = 2
"""Registers that a block begins with: identity and configuration."""


def _fields(registers: Sequence[Register], words: Sequence[int]) -> Iterator[tuple[str, int]]:
    at = 0
    for register in registers:
        yield from register.unpack(words[at : at + register.words]).items()
        at += register.words
