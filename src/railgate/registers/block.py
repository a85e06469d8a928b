"""Registers of one function: alone, and in groups that belong to one tick, at their offsets."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum
from functools import cached_property

from railgate.field import Field
from railgate.registers.register import WORD_BYTES, Access, Register, require_name

__all__ = ["Block", "Gate", "Group", "Place", "require_unique"]


class Gate(Enum):
    """What a read of a group's first word does before it is answered.

    All three make the group's words belong to one tick, whatever time the other words' reads take.
    """

    LATCH = "latch"
    """The bank copies all of the group's fields as they are in one tick."""
    TAKE = "take"
    """As LATCH, and the stream whose entry these fields are is advanced. While the stream is empty
    the fields are 0."""
    STROBE = "strobe"
    """The function is strobed, and holds its fields itself until the next strobe. Every read of
    this group is answered only when no strobe is under way."""


@dataclass(frozen=True, kw_only=True)
class Group:
    """Registers that are read as of one tick: the gate is a read of the first word.

    A group has two places in its block, of the same size and layout. At the first one, a read of
    the first word is the gate. At the second one, `again`, the same words are read without a gate:
    where a reply was lost, or where something else was the gate. Raises ValueError.
    """

    name: str
    description: str
    registers: tuple[Register, ...]
    gate: Gate

    def __post_init__(self) -> None:
        if not self.registers:
            raise ValueError(f"{self.name} must have at least one register")
        for each in self.registers:
            if each.access is not Access.READ:
                raise ValueError(
                    "registers of a group must be for reading, "
                    f"not {each.name} for {each.access.value}"
                )

    @property
    def words(self) -> int:
        return sum(each.words for each in self.registers)


@dataclass(frozen=True)
class Place:
    """Where a register is in its block: byte offsets of its first word.

    group: whose it is, None where it stands alone. again: its second place, None where it stands
    alone.
    """

    register: Register
    offset: int
    group: Group | None = None
    again: int | None = None


@dataclass(frozen=True, kw_only=True)
class Block:
    """A function's registers, alone and in groups, one after the other from offset 0.

    A register alone has one word, unless it is constant. Raises ValueError where it has not, or
    where two registers, groups or fields have the same name.
    """

    name: str
    description: str
    entries: tuple[Register | Group, ...]

    def __post_init__(self) -> None:
        require_name(self.name)
        if not self.entries:
            raise ValueError(f"{self.name} must have at least one register")
        for entry in self.entries:
            alone = isinstance(entry, Register) and entry.access is not Access.CONSTANT
            if alone and entry.words > 1:
                raise ValueError(
                    f"{entry.name} must be in a group, to have {entry.words} words of one tick"
                )
        groups = [entry.name for entry in self.entries if isinstance(entry, Group)]
        require_unique(self.name, (*(each.name for each in self.registers), *groups))
        fields = [name for each in self.registers for name in each.field_names]
        require_unique(self.name, fields)
        for each in self.registers:
            for counter in each.counters:
                if counter not in fields:
                    raise ValueError(f'{self.name} has no field "{counter}" to set {each.name} by')

    @cached_property
    def places(self) -> tuple[Place, ...]:
        """Each register's, in their order."""
        found: list[Place] = []
        offset = 0
        for entry in self.entries:
            if isinstance(entry, Register):
                found.append(Place(entry, offset))
                offset += entry.words * WORD_BYTES
                continue
            size = entry.words * WORD_BYTES
            for each in entry.registers:
                found.append(Place(each, offset, entry, offset + size))
                offset += each.words * WORD_BYTES
            offset += size
        return tuple(found)

    @property
    def registers(self) -> tuple[Register, ...]:
        """All of them, in their order."""
        return tuple(
            each
            for entry in self.entries
            for each in (entry.registers if isinstance(entry, Group) else (entry,))
        )

    @cached_property
    def fields(self) -> dict[str, Field]:
        """All fields of all registers, by name."""
        return {field.name: field for each in self.registers for field in each.fields}

    @property
    def groups(self) -> tuple[Group, ...]:
        return tuple(entry for entry in self.entries if isinstance(entry, Group))

    def place(self, name: str) -> Place:
        """Of the register of that name, or of a group's first one. Raises ValueError."""
        for each in self.places:
            if each.register.name == name or (each.group and each.group.name == name):
                return each
        told = ", ".join(each.register.name for each in self.places)
        raise ValueError(f'no register "{name}" in {self.name}; there are: {told}')

    @property
    def words(self) -> int:
        """From offset 0 to the end of the last register."""
        return sum(entry.words * (2 if isinstance(entry, Group) else 1) for entry in self.entries)

    @property
    def size(self) -> int:
        """Bytes that it takes in a map: a power of two, of which its base is a multiple."""
        return 1 << (self.words * WORD_BYTES - 1).bit_length()


def require_unique(owner: str, names: Iterable[str]) -> None:
    """Raises ValueError where a name is there more than once."""
    twice = [name for name, count in Counter(names).items() if count > 1]
    if twice:
        raise ValueError(f"names in {owner} must differ, not be twice {', '.join(twice)}")
