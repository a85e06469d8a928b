"""One register: its fields, and what the bus can do to it."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum, IntEnum, IntFlag
from functools import cached_property

from railgate.field import Field

__all__ = ["WORD_BITS", "WORD_BYTES", "Access", "Register", "Values", "require_name"]

WORD_BITS = 32
WORD_BYTES = 4

Values = type[IntEnum] | type[IntFlag]
"""A type that names the values of a field."""

NAME = re.compile(r"[a-z][a-z0-9_]*")


def require_name(name: str) -> None:
    """Raises ValueError unless it can be a name in a map."""
    if not NAME.fullmatch(name):
        raise ValueError(f'a name must be lower case as "sum_a", not "{name}"')


class Access(Enum):
    """What the bus can do to a register; anything else is answered as an error."""

    CONSTANT = "constant"
    """Read; always its fields' start values."""
    READ = "read"
    """Read; what the function holds."""
    READ_TO_CLEAR = "read to clear"
    """Read; sticky: bits that the function sets stay set until a read has told them."""
    WRITE_ONE_TO_CLEAR = "write one to clear"
    """Read and write; sticky: bits that the function sets stay set until a 1 is written to them."""
    READ_WRITE = "read, write"
    """Read and write; what was written last, the fields' start values at first."""
    TRIGGER = "write to trigger"
    """Write; each bit written as 1 is 1 for one tick."""

    @property
    def reads(self) -> bool:
        return self is not Access.TRIGGER

    @property
    def writes(self) -> bool:
        return self in (Access.WRITE_ONE_TO_CLEAR, Access.READ_WRITE, Access.TRIGGER)

    @property
    def sticky(self) -> bool:
        return self in (Access.READ_TO_CLEAR, Access.WRITE_ONE_TO_CLEAR)


@dataclass(frozen=True, kw_only=True)
class Register:
    """Fields in one word, packed from bit 0 up, or one field in as many words as it needs, low word
    first.

    name: lower case with digits and underscores. values: of the fields that have one, by name, the
    type that names their values: flags, or numbers; a field that is a multiple as wide as the
    type's greatest number is an array of them, from bit 0 up. counters: of a sticky register whose
    fields have 1 bit each: for each field the counter, another field of the block, whose step by
    one sets it; without counters the function sets the bits by a port of the field's name.
    Raises ValueError.
    """

    name: str
    fields: tuple[Field, ...]
    access: Access = Access.READ
    values: Mapping[str, Values] = field(default_factory=dict)
    counters: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for name in (self.name, *self.field_names):
            require_name(name)
        if not self.fields:
            raise ValueError(f"{self.name} must have at least one field")
        if len(self.fields) > 1 and self.width > WORD_BITS:
            raise ValueError(
                f"the fields of {self.name} must share {WORD_BITS} bits, not {self.width}"
            )
        for name, named in self.values.items():
            if name not in self.field_names:
                raise ValueError(f'{self.name} has no field "{name}" to name the values of')
            width, bits = self.field(name).width, max(named).bit_length()
            if width % bits:
                raise ValueError(
                    f"{name} must be a multiple of {named.__name__}'s {bits} bits wide, not {width}"
                )
        if self.counters and not (
            self.access.sticky
            and len(self.counters) == len(self.fields)
            and all(each.width == 1 for each in self.fields)
        ):
            raise ValueError(
                f"{self.name} must be sticky, with a 1-bit field for each of its counters"
            )

    @property
    def field_names(self) -> tuple[str, ...]:
        return tuple(each.name for each in self.fields)

    def field(self, name: str) -> Field:
        """The field of that name. Raises ValueError."""
        for each in self.fields:
            if each.name == name:
                return each
        raise ValueError(f'no field "{name}" in {self.name}; there are: {self._told}')

    @property
    def _told(self) -> str:
        return ", ".join(self.field_names)

    @cached_property
    def shifts(self) -> tuple[int, ...]:
        """Of each field its lowest bit, counted from bit 0 of the first word."""
        widths = [each.width for each in self.fields]
        return tuple(sum(widths[:at]) for at in range(len(widths)))

    @property
    def width(self) -> int:
        """Of all fields, bits."""
        return sum(each.width for each in self.fields)

    @property
    def words(self) -> int:
        return -(-self.width // WORD_BITS)

    def pack(self, values: Mapping[str, int]) -> tuple[int, ...]:
        """The register's words that hold these values; fields left out are 0. Raises ValueError."""
        whole = 0
        for name, value in values.items():
            each = self.field(name)
            low = -(1 << each.width - 1) if each.signed else 0
            high = low + (1 << each.width) - 1
            if not low <= value <= high:
                raise ValueError(f"{name} must be between {low} and {high}, not {value}")
            shift = self.shifts[self.fields.index(each)]
            whole |= (value & (1 << each.width) - 1) << shift
        mask = (1 << WORD_BITS) - 1
        return tuple(whole >> WORD_BITS * at & mask for at in range(self.words))

    def unpack(self, words: Sequence[int]) -> dict[str, int]:
        """Each field's value in the register's words. Raises ValueError."""
        if len(words) != self.words:
            raise ValueError(f"{self.name} must have {self.words} words, not {len(words)}")
        whole = sum(word << WORD_BITS * at for at, word in enumerate(words))
        values = {}
        for each, shift in zip(self.fields, self.shifts, strict=True):
            value = whole >> shift & (1 << each.width) - 1
            negative = each.signed and value >> each.width - 1
            values[each.name] = value - (1 << each.width) if negative else value
        return values
