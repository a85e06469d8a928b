"""Fields as tools outside know them: each within one word, each flag by itself."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import IntEnum, IntFlag

from railgate.field import Field
from railgate.registers.register import WORD_BITS, Register, Values

__all__ = ["Piece", "pieces", "word_name"]


@dataclass(frozen=True, kw_only=True)
class Piece:
    """Bits of one word of a register: a field, a part of a wide one, or a flag.

    word: which of the register's. low: the lowest bit in it. start: what these bits hold at start.
    kind: names their values, None where they have no names.
    """

    name: str
    word: int
    low: int
    width: int
    meaning: str
    start: int
    signed: bool = False
    kind: type[IntEnum] | None = None


def pieces(register: Register) -> Iterator[Piece]:
    """All of a register, from bit 0 up: `<field>`, of one of flags `<field>_<flag>` each, of one in
    several words `<field>_<word>` each, 0 the low one. Only the highest part of a signed field is
    signed."""
    for field, shift in zip(register.fields, register.shifts, strict=True):
        values = register.values.get(field.name)
        single = values is not None and max(values).bit_length() == field.width
        if single and values is not None and issubclass(values, IntFlag):
            yield from _flags(field, shift, values)
        else:
            kind = values if single and values is not None and issubclass(values, IntEnum) else None
            yield from _parts(field, shift, kind, _told(field, values))


def word_name(register: Register, word: int) -> str:
    """What one word of a register is called: as the register, if it has no other."""
    return register.name if register.words == 1 else f"{register.name}_{word}"


def _flags(field: Field, shift: int, flags: type[IntFlag]) -> Iterator[Piece]:
    for flag in flags:
        at = flag.bit_length() - 1
        word, low = divmod(shift + at, WORD_BITS)
        yield Piece(
            name=f"{field.name}_{str(flag.name).lower()}",
            word=word,
            low=low,
            width=1,
            meaning=field.meaning,
            start=field.start >> at & 1,
        )


def _parts(field: Field, shift: int, kind: type[IntEnum] | None, told: str) -> Iterator[Piece]:
    """The field, cut where words end."""
    end = shift + field.width
    first, last = shift // WORD_BITS, (end - 1) // WORD_BITS
    bits = field.start & (1 << field.width) - 1
    for word in range(first, last + 1):
        low = max(shift, word * WORD_BITS)
        high = min(end, (word + 1) * WORD_BITS)
        cut = first != last
        yield Piece(
            name=f"{field.name}_{word}" if cut else field.name,
            word=word,
            low=low % WORD_BITS,
            width=high - low,
            meaning=f"{told}; its bits {high - shift - 1}:{low - shift}" if cut else told,
            start=bits >> low - shift & (1 << high - low) - 1,
            signed=field.signed and word == last,
            kind=None if cut else kind,
        )


def _told(field: Field, values: Values | None) -> str:
    """Its meaning, its unit, and where it is an array of named values, what they are."""
    told = f"{field.meaning}, in {field.unit}" if field.unit else field.meaning
    if values is None or (bits := max(values).bit_length()) == field.width:
        return told
    named = ", ".join(f"{str(each.name).lower()} {each.value}" for each in values)
    return f"{told}; {bits} bits each: {named}"
