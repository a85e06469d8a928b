"""What the bits of a word mean: from words to engineering units and back (LNK-8).

Bit word_bits - 1 is the first on the line, bit 0 the last. Every bit belongs to a field, to the
check or to `unused`, and to one of them only.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railgate.position_link.host.words import (
    Words,
    check_fields,
    extract,
    insert,
    pack,
    parted,
    sound,
    unpack,
)
from railgate.position_link.spec import Check, Config

__all__ = ["Bits", "Column", "Layout", "Values", "WordField", "guarantee"]

Column = NDArray[Any]
"""A field of many words, shape (n,): float64, but int64 or uint64 without scale and offset."""

Values = Sequence[float | Fraction] | NDArray[Any]

EXACT = 1 << 53
"""Up to here every integer is a float."""


def guarantee(check: Check | None) -> str:
    """What a check field says of the word, in words (LNK-7)."""
    if check is None:
        return "without a check field a fault of DATA alone is not seen"
    return f"of words with random DATA one in {1 << check.width} passes the check field"


@dataclass(frozen=True)
class Bits:
    """Bits msb down to lsb of a word, both counted in. Raises ValueError."""

    msb: int
    lsb: int

    def __post_init__(self) -> None:
        if not 0 <= self.lsb <= self.msb:
            raise ValueError(f"bits must be msb..lsb, as 63..24, not {self.msb}..{self.lsb}")

    @classmethod
    def of(cls, text: str) -> Bits:
        """From `63..24`, or `7` for one bit. Raises ValueError."""
        found = re.fullmatch(r"(\d{1,4})(?:\.\.(\d{1,4}))?", text, re.ASCII)
        if not found:
            raise ValueError(f'bits must be msb..lsb, as 63..24, or one bit, not "{text}"')
        return cls(int(found[1]), int(found[2] or found[1]))

    @property
    def width(self) -> int:
        return self.msb - self.lsb + 1

    def __str__(self) -> str:
        return f"{self.msb}..{self.lsb}" if self.width > 1 else f"{self.lsb}"


@dataclass(frozen=True, kw_only=True)
class WordField:
    """One field of the word: raw · scale + offset, in `unit`. Raises ValueError.

    bits: at most 64 of them. gray: a Gray code, undone first. signed: then two's complement.
    The arithmetic is exact up to one last rounding to float; a field without scale and offset is a
    whole number and stays one.
    """

    name: str
    bits: Bits
    signed: bool = False
    gray: bool = False
    scale: Fraction = Fraction(1)
    offset: Fraction = Fraction(0)
    unit: str = ""

    def __post_init__(self) -> None:
        if not self.name.isidentifier():
            raise ValueError(f'name must be letters, digits and _, as speed_2, not "{self.name}"')
        if self.bits.width > 64:
            raise ValueError(f"bits must be at most 64, not {self.bits.width} ({self.bits})")
        huge = 10**30
        if not Fraction(1, huge) <= abs(self.scale) <= huge:
            raise ValueError(f"scale must be between 1e-30 and 1e30 in size, not {self.scale}")
        if abs(self.offset) > huge:
            raise ValueError(f"offset must be at most 1e30 in size, not {self.offset}")

    @property
    def raw_range(self) -> tuple[int, int]:
        """The least and the greatest raw number."""
        low = -(1 << self.bits.width - 1) if self.signed else 0
        return low, low + (1 << self.bits.width) - 1

    @property
    def range(self) -> tuple[float, float]:
        """The least and the greatest value, in `unit`."""
        low, high = sorted(raw * self.scale + self.offset for raw in self.raw_range)
        return (int(low), int(high)) if self._whole else (float(low), float(high))

    @property
    def _whole(self) -> bool:
        return self.scale == 1 and not self.offset

    @cached_property
    def _line(self) -> tuple[int, int, int]:
        """Integers p, o, q: a value is (raw · p + o) / q."""
        q = math.lcm(self.scale.denominator, self.offset.denominator)
        return int(self.scale * q), int(self.offset * q), q

    def decode(self, words: Words) -> Column:
        """The values of this field. words: (n, parts)."""
        bits = extract(words, self.bits.lsb, self.bits.width)
        if self.gray:
            for shift in (1, 2, 4, 8, 16, 32):
                bits ^= bits >> shift
        above = 64 - self.bits.width
        raw: Column = bits
        if self.signed:
            raw = (bits << above).view(np.int64) >> above
        if self._whole:
            return raw
        p, o, q = self._line
        if max(max(map(abs, self.raw_range)) * abs(p) + abs(o), q) <= EXACT:
            return (raw * np.float64(p) + np.float64(o)) / np.float64(q)
        return np.array([(number * p + o) / q for number in raw.tolist()], np.float64)

    def encode(self, values: Values) -> NDArray[np.uint64]:
        """The bits of the raw numbers nearest to the values. Raises ValueError."""
        whole = isinstance(values, np.ndarray) and values.dtype.kind in "iu" and self._whole
        raw = values if whole else [self._raw(value) for value in values]
        low, high = self.raw_range
        if len(raw) and not (low <= min(raw) and max(raw) <= high):
            at = next(i for i, number in enumerate(raw) if not low <= number <= high)
            raise self._unfit(values[at])
        number = np.asarray(raw, np.int64 if self.signed else np.uint64)
        bits = number.astype(np.uint64) & np.uint64((1 << self.bits.width) - 1)
        return bits ^ bits >> np.uint64(1) if self.gray else bits

    def _raw(self, value: float | Fraction) -> int:
        """The raw number nearest to the value, upwards from halfway."""
        p, o, q = self._line
        try:
            above, below = value.as_integer_ratio()
        except (OverflowError, ValueError):
            raise self._unfit(value) from None
        return (2 * (above * q - o * below) + p * below) // (2 * p * below)

    def _unfit(self, value: float | Fraction) -> ValueError:
        low, high = (f"{bound:.15g}" if bound % 1 else f"{bound:.0f}" for bound in self.range)
        unit = f" {self.unit}" if self.unit else ""
        return ValueError(f"{self.name} must be between {low} and {high}{unit}, not {value}")


@dataclass(frozen=True, kw_only=True)
class Layout:
    """The word of one position system. Raises ValueError at the first thing that does not hold.

    word_bits, fault_word, zero_is_fault, check: as in Config. The check is the last bits of the
    word; without one a fault of DATA alone is not seen, and a false position looks like any other.
    fields: in the order in which they are shown. unused: bits that mean nothing; sent as 0, not
    looked at.
    """

    word_bits: int
    fields: tuple[WordField, ...]
    unused: tuple[Bits, ...] = ()
    fault_word: int | None = None
    zero_is_fault: bool = False
    check: Check | None = None

    def __post_init__(self) -> None:
        _ = self.config
        if not self.fields:
            raise ValueError("a word must have at least one field, not none")
        names = [field.name for field in self.fields]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f'fields must have different names, not two "{name}"')
        self._require_each_bit_once()

    def _require_each_bit_once(self) -> None:
        taken = [(field.bits, f'field "{field.name}"') for field in self.fields]
        taken += [(bits, "unused") for bits in self.unused]
        if self.check:
            taken.append((Bits(self.check.width - 1, 0), "the check"))
        above, owner = self.word_bits, ""
        for bits, what in sorted(taken, key=lambda one: -one[0].msb):
            if bits.msb >= self.word_bits:
                raise ValueError(f"{what} must be in bits {self.word_bits - 1}..0, not {bits}")
            if bits.msb >= above:
                raise ValueError(f"{what} must not share bits with {owner}, not be {bits}")
            self._require_no_gap(above, bits.msb + 1)
            above, owner = bits.lsb, f"{what} ({bits})"
        self._require_no_gap(above, 0)

    def _require_no_gap(self, above: int, lsb: int) -> None:
        if above > lsb:
            raise ValueError(
                f"each bit must be of a field, the check or unused, not bits {Bits(above - 1, lsb)}"
            )

    def applied_to(self, config: Config) -> Config:
        """The same link for words of this layout. Raises ValueError."""
        return replace(
            config,
            word_bits=self.word_bits,
            fault_word=self.fault_word,
            zero_is_fault=self.zero_is_fault,
            check=self.check,
        )

    @cached_property
    def config(self) -> Config:
        """A link of defaults for words of this layout."""
        return self.applied_to(Config())

    def columns(self, words: Words) -> dict[str, Column]:
        """The fields of many words, name by name; of any bits, the fault word's too.

        words: uint64, (n,) up to 64 bits, else (n, parts) of 64 bits each, the least significant
        first. Raises ValueError for another shape.
        """
        rows = parted(words, self.word_bits)
        return {field.name: field.decode(rows) for field in self.fields}

    def words(self, columns: Mapping[str, Values]) -> Words:
        """The words that say this, check included, in the shape that `columns` takes.

        Each value is rounded to the nearest that its field can hold. Raises ValueError where a
        field is missing or unknown, where a value does not fit, and where a word would be none.
        """
        names = [field.name for field in self.fields]
        if odd := sorted(columns.keys() ^ set(names)):
            raise ValueError(f"values must be of {', '.join(names)}, not differ in {odd[0]}")
        counts = {name: len(columns[name]) for name in names}
        n = counts[names[0]]
        if set(counts.values()) != {n}:
            raise ValueError(f"each field must have as many values as {names[0]}, not {counts}")
        rows = np.zeros((n, -(-self.word_bits // 64)), np.uint64)
        for field in self.fields:
            insert(rows, field.bits.lsb, field.bits.width, field.encode(columns[field.name]))
        if self.check:
            rows[:, 0] |= check_fields(rows, self.word_bits, self.check)
        if not (good := sound(rows, self.config)).all():
            word = unpack(rows[~good][:1])[0]
            raise ValueError(f"values must not make {word:#x}, which is no valid word")
        return rows[:, 0] if rows.shape[1] == 1 else rows

    def decode(self, word: int) -> dict[str, float]:
        """The fields of one word. Raises ValueError where it has too many bits."""
        columns = self.columns(pack([word], self.word_bits))
        return {name: column[0].item() for name, column in columns.items()}

    def encode(self, values: Mapping[str, float | Fraction]) -> int:
        """The word that says this. Raises ValueError, as `words` does."""
        return unpack(self.words({name: [value] for name, value in values.items()}))[0]
