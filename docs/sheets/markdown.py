"""Markdown as makers write it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from fractions import Fraction

__all__ = ["between", "code", "html", "number", "small", "table"]

BACKQUOTES = "`" * 5
"""More than any text has."""
SPACE = re.compile(r"[ \n]+")
"""That lines may break at."""
NARROW, WIDE = "\N{NARROW NO-BREAK SPACE}", "\N{NO-BREAK SPACE}"
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table; cells are Markdown of one line."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join(f"| {' | '.join(map(_cell, line))} |" for line in lines) + "\n"


def _cell(text: str) -> str:
    return SPACE.sub(" ", text).replace("|", r"\|")


def code(text: str, language: str = "text") -> str:
    """A block of text as it is."""
    return f"{BACKQUOTES}{language}\n{text}\n{BACKQUOTES}\n"


def html(text: str) -> str:
    """HTML as it is."""
    return f"{BACKQUOTES}{{raw}} html\n{text}\n{BACKQUOTES}\n"


def number(value: object) -> str:
    """A number as a person writes it: whole ones in groups of three digits."""
    if isinstance(value, bool) or not isinstance(value, int | float | Fraction):
        return str(value)
    if value == int(value):
        return f"{int(value):,}".replace(",", NARROW)
    return f"{float(value):.7g}"


def small(value: float) -> str:
    """A number to two digits; a very small one by a power of ten."""
    digits, _, exponent = f"{value:.2g}".partition("e")
    return f"{digits}·10{str(int(exponent)).translate(RAISED)}" if exponent else digits


def between(low: str, high: str) -> str:
    """A range, which no line breaks."""
    return f"{low}{WIDE}…{WIDE}{high}"
