"""A function's configuration from a TOML file: keys are the configuration's own fields."""

from __future__ import annotations

from dataclasses import MISSING, fields, is_dataclass
from decimal import Decimal
from enum import IntEnum
from fractions import Fraction
from pathlib import Path
from types import NoneType, UnionType
from typing import TYPE_CHECKING, Any, TypeVar, get_args, get_origin, get_type_hints

from railgate.toml_file import parse_toml, read_text

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

__all__ = ["read_configuration"]

Kind = TypeVar("Kind", bound="DataclassInstance")

WHAT = {
    int: "a whole number",
    bool: "true or false",
    Fraction: 'a number, as 0.05, or a ratio, as "1/20"',
}
"""What a value of each type must be."""


def read_configuration(kind: type[Kind], path: Path) -> Kind:
    """Of that kind, with defaults for what the file leaves out. Raises ValueError, in one line."""
    text = read_text(path, "a configuration")
    return parse_toml(text, str(path), lambda table: _made(kind, table))


def _made(kind: type[Any], table: dict[str, Any]) -> Any:
    types = get_type_hints(kind)
    names = [each.name for each in fields(kind)]
    for key in table:
        if key not in names:
            raise ValueError(f'no key "{key}" is known; there are: {", ".join(names)}')
    if missing := [n for n in _required(kind) if n not in table]:
        raise ValueError(f"the key {missing[0]} is missing")
    return kind(**{key: _value(key, types[key], value) for key, value in table.items()})


def _required(kind: type[Any]) -> list[str]:
    return [f.name for f in fields(kind) if f.default is MISSING and f.default_factory is MISSING]


def _value(key: str, kind: Any, value: Any) -> Any:
    """The value as one of that type. Raises ValueError."""
    if get_origin(kind) is UnionType:
        (kind,) = (each for each in get_args(kind) if each is not NoneType)
    if isinstance(kind, type) and is_dataclass(kind) and isinstance(value, dict):
        return _made(kind, value)
    if get_origin(kind) is tuple and isinstance(value, list):
        if len(value) != len(get_args(kind)):
            raise ValueError(f"{key} must have {len(get_args(kind))} values, not {len(value)}")
        return tuple(_value(key, of, v) for of, v in zip(get_args(kind), value, strict=True))
    if isinstance(kind, type) and issubclass(kind, IntEnum):
        there = {each.name.lower(): each for each in kind}
        if not isinstance(value, str) or value not in there:
            raise ValueError(f"{key} must be one of {', '.join(there)}, not {value}")
        return there[value]
    if (number := _number(kind, value)) is None:
        raise ValueError(f"{key} must be {WHAT.get(kind, 'a table or list')}, not {value}")
    return number


def _number(kind: Any, value: Any) -> bool | int | Fraction | None:
    """None where it is none of that type."""
    if kind is bool or isinstance(value, bool):
        return value if kind is bool and isinstance(value, bool) else None
    if kind is int:
        return value if isinstance(value, int) else None
    if kind is Fraction:
        short = isinstance(value, int) or (
            isinstance(value, Decimal) and value.is_finite() and abs(value.adjusted()) < 50
        )
        if short:
            return Fraction(value)
        if isinstance(value, str):
            over, _, under = value.partition("/")
            if over.isdecimal() and under.isdecimal() and len(value) < 80 and int(under):
                return Fraction(int(over), int(under))
    return None
