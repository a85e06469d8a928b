"""TOML files that people write: what is wrong with one is told in one line, with the line's number.

A reader of a file makes of its tables what it needs, and raises MisplacedError with the place.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable
from decimal import Decimal
from pathlib import Path
from typing import Any, TypeVar

__all__ = ["MisplacedError", "Place", "parse_toml", "read_text"]

Made = TypeVar("Made")
Place = tuple[str, int, str]
"""Where a key stands: its table, which one of an array of tables, its name."""

HEADER = re.compile(r"\s*(\[\[?)\s*([\w.-]+)\s*\]")
KEY = re.compile(r"\s*([\w-]+)\s*=")


class MisplacedError(ValueError):
    """What is wrong with one key or table."""

    def __init__(self, place: Place, reason: str) -> None:
        super().__init__(reason)
        self.place = place


def read_text(path: str | Path, what: str) -> str:
    """The text of a file. what: it is, for errors, as "a scenario". Raises ValueError."""
    try:
        return Path(path).read_text("utf-8")
    except OSError as error:
        raise ValueError(f"{path}: {error.strerror or error}") from error
    except ValueError as error:
        raise ValueError(f"{path}: {what} must be text in UTF-8") from error


def parse_toml(text: str, name: str, make: Callable[[dict[str, Any]], Made]) -> Made:
    """What is made of the document; `name` is the file's, for errors.

    Decimal fractions come as Decimal. Raises ValueError, in one line, of a MisplacedError with the
    line of what is wrong.
    """
    try:
        return make(tomllib.loads(text, parse_float=Decimal))
    except MisplacedError as error:
        line = _line(text, error.place)
        raise ValueError(f"{name}:{line}: {_printable(error)}") from error
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{name}: {_printable(error)}") from error


def _printable(error: Exception) -> str:
    """One line; names in a file may hold a terminal's control sequences."""
    told = " ".join(str(error).split())[:500]
    return "".join(c if c.isprintable() else "?" for c in told)


def _line(text: str, place: Place) -> int:
    """The line of a key; of its table's header where it has none."""
    table, number, key = "", 0, ""
    counts: dict[str, int] = {}
    nearest = 1
    for line, content in enumerate(text.splitlines(), 1):
        if header := HEADER.match(content):
            table = header[2]
            counts[table] = number = counts.get(table, -1) + 1
            key = ""
        elif found := KEY.match(content):
            key = found[1]
        else:
            continue
        if (table, number) == place[:2] or (table, place[0]) == ("", ""):
            if key == place[2]:
                return line
            nearest = line if not key else nearest
    return nearest
