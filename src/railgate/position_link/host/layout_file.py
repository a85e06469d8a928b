"""Layouts from TOML files, as `example.toml` beside this module is one (LNK-8)."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from decimal import Context, Decimal
from fractions import Fraction
from functools import partial
from importlib import resources
from pathlib import Path
from typing import Any

from railgate.position_link.host.layout import Bits, Layout, WordField
from railgate.position_link.spec import EVEN, ODD, Check

__all__ = ["example", "parse_layout", "read_layout"]

Reader = Callable[[str, object], Any]
"""Makes of a key and what the file says of it what a layout needs. Raises ValueError."""


INTEGER = re.compile(r"0x_?[0-9a-fA-F]+(_[0-9a-fA-F]+)*|0|[1-9][0-9]{0,199}")
DECIMAL = partial(Decimal, context=Context(traps=[]))
"""What is no number, or too great for one, is NaN."""


def read_layout(path: str | Path) -> Layout:
    """The layout in a TOML file. Raises ValueError, in one line, for whatever is wrong with it."""
    try:
        text = Path(path).read_text("utf-8")
    except OSError as error:
        raise ValueError(f"{path}: {error.strerror or error}") from error
    except ValueError as error:
        raise ValueError(f"{path}: a layout must be text in UTF-8") from error
    return parse_layout(text, str(path))


def parse_layout(text: str, name: str) -> Layout:
    """The layout that a TOML text describes; `name` is the file's, for errors.

    Raises ValueError, in one line.
    """
    try:
        return _layout(tomllib.loads(text, parse_float=DECIMAL))
    except (ValueError, RecursionError) as error:
        reason = " ".join(str(error).split())[:500]
        # Names in a file may hold a terminal's control sequences.
        reason = "".join(c if c.isprintable() else "?" for c in reason)
        raise ValueError(f"{name}: {reason}") from error


def example() -> Layout:
    """The layout of `example.toml`: position, speed, a sequence number, and a CRC of 8 bits."""
    file = resources.files(__package__).joinpath("example.toml")
    return parse_layout(file.read_text("utf-8"), file.name)


def _integer(key: str, value: object) -> int:
    if isinstance(value, str) and INTEGER.fullmatch(value):
        value = int(value, 0)
    if isinstance(value, bool) or not isinstance(value, int):
        raise ValueError(f"{key} must be a whole number, not {value}")
    return value


def _exact(key: str, value: object) -> Fraction:
    """The number to its last digit."""
    if isinstance(value, str) and re.fullmatch(r"-?\d{1,40}/0*[1-9]\d{0,40}", value):
        return Fraction(value)
    if isinstance(value, int) and not isinstance(value, bool):
        return Fraction(value)
    if isinstance(value, Decimal) and value.is_finite() and abs(value.adjusted()) < 50:
        return Fraction(value)
    raise ValueError(f'{key} must be a number, as 0.001, or a ratio, as "1/1024", not {value}')


def _flag(key: str, value: object) -> bool:
    if not isinstance(value, bool):
        raise ValueError(f"{key} must be true or false, not {value}")
    return value


def _text(key: str, value: object) -> str:
    if not isinstance(value, str):
        raise ValueError(f"{key} must be a text, not {value}")
    return value


def _bits(key: str, value: object) -> Bits:
    return Bits.of(_text(key, value))


def _list(key: str, value: object) -> list[object]:
    if not isinstance(value, list):
        raise ValueError(f"{key} must be a list, not {value}")
    return value


def _unused(key: str, value: object) -> tuple[Bits, ...]:
    return tuple(_bits(key, one) for one in _list(key, value))


def _check(key: str, value: object) -> Check:
    try:
        kind = value.get("kind") if isinstance(value, dict) else None
        if kind == "crc":
            entries = _entries(value, CHECK, ["width", "polynomial"])
            del entries["kind"]
            return Check(**entries)
        if kind not in ("even", "odd"):
            raise ValueError(f"kind must be even, odd or crc, not {kind}")
        _entries(value, {"kind": _text})
        return EVEN if kind == "even" else ODD
    except ValueError as error:
        raise ValueError(f"{key}: {error}") from error


def _fields(key: str, value: object) -> tuple[WordField, ...]:
    found = []
    for number, table in enumerate(_list(key, value), 1):
        name = table.get("name", number) if isinstance(table, dict) else number
        try:
            found.append(WordField(**_entries(table, FIELD, ["name", "bits"])))
        except ValueError as error:
            raise ValueError(f"{key} {name}: {error}") from error
    return tuple(found)


CHECK = {
    "kind": _text,
    "width": _integer,
    "polynomial": _integer,
    "initial": _integer,
    "final": _integer,
}
FIELD: dict[str, Reader] = {
    "name": _text,
    "bits": _bits,
    "signed": _flag,
    "gray": _flag,
    "scale": _exact,
    "offset": _exact,
    "unit": _text,
}
LAYOUT: dict[str, Reader] = {
    "word_bits": _integer,
    "fault_word": _integer,
    "zero_is_fault": _flag,
    "unused": _unused,
    "check": _check,
    "field": _fields,
}


def _entries(
    table: object, readers: Mapping[str, Reader], required: Sequence[str] = ()
) -> dict[str, Any]:
    """What a table says, key by key. Raises ValueError for an unknown or a missing key."""
    if not isinstance(table, dict):
        raise ValueError(f"a table is needed, not {table}")
    for key in table:
        if key not in readers:
            raise ValueError(f'no key "{key}" is known; there are: {", ".join(readers)}')
    for key in required:
        if key not in table:
            raise ValueError(f"the key {key} is missing")
    return {key: readers[key](key, value) for key, value in table.items()}


def _layout(document: dict[str, Any]) -> Layout:
    entries = _entries(document, LAYOUT, ["word_bits", "field"])
    return Layout(fields=entries.pop("field"), **entries)
