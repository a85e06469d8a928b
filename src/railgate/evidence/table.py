"""The matrix as a person reads it in a terminal."""

from __future__ import annotations

from collections.abc import Iterator

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from railgate.evidence.matrix import KINDS, Matrix, Row, Status

__all__ = ["age", "count", "show"]

UNITS = ((86400, "d"), (3600, "h"), (60, "min"))
STYLES = {Status.GREY: "dim"}


def show(matrix: Matrix) -> RenderableType:
    """A line for each requirement, then what is to be said of those that are red, and counts."""
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for name in ("", "requirement", "status"):
        table.add_column(name, no_wrap=name != "requirement")
    for name in (*KINDS, "oldest"):
        table.add_column(name, justify="right", no_wrap=True)
    for row in matrix.rows:
        counts = [count(row, kind) for kind in KINDS]
        status = Text(row.status.value, STYLES.get(row.status, row.status.value))
        named = (row.requirement.name, row.requirement.sentence, status)
        table.add_row(*named, *counts, age(row.oldest, matrix.at))
    counted = ", ".join(f"{len(matrix.having(status))} {status.value}" for status in Status)
    return Group(table, *(Text(line) for line in _remarks(matrix)), Text(counted))


def age(at: float | None, now: float) -> str:
    """How long ago, in the largest unit of which it is at least one; nothing where it never was."""
    if at is None:
        return ""
    return next((f"{(now - at) // s:.0f} {unit}" for s, unit in UNITS if now - at >= s), "now")


def count(row: Row, kind: str) -> str:
    """How many of a kind passed of how many there are."""
    of = row.of(kind)
    passed = [each for each in of if each.result in ("passed", "cited")]
    if not of:
        return "–"
    return f"{len(of)}" if len(passed) == len(of) else f"{len(passed)} of {len(of)}"


def _remarks(matrix: Matrix) -> Iterator[str]:
    for row in matrix.having(Status.RED):
        failed = [f"{each.name} failed" for each in row.evidence if each.result == "failed"]
        yield f"{row.requirement.name}: {', '.join(failed) or 'nothing shows it'}"
