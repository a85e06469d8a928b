"""The figures as a table."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from railgate.fpga.report import SEEDS, Row
from railgate.fpga.targets import CEILING, TARGETS

__all__ = ["show"]

MET = {True: Text("met", "green"), False: Text("not met", "red"), None: Text("")}
"""Of a goal."""


def show(rows: Sequence[Row]) -> RenderableType:
    """For each part a table of all targets, beside the part's ceiling, and what is to be said."""
    by_part: dict[str, list[Row]] = {}
    for row in rows:
        by_part.setdefault(row.part, []).append(row)
    pieces: list[RenderableType] = []
    for of in by_part.values():
        pieces += [_table(of), *_remarks(of)]
    return Group(*pieces)


def _table(rows: Sequence[Row]) -> Table:
    table = Table(header_style="bold")
    for name in ("target", "kind"):
        table.add_column(name, no_wrap=True)
    for name in (
        "worst MHz",
        "median MHz",
        "of ceiling",
        "LUT",
        "FF",
        "RAM",
        "DSP",
        "of peer",
        "goal MHz",
    ):
        table.add_column(name, justify="right")
    table.add_column("goal")
    ceiling = next((row.median_mhz for row in rows if row.target == CEILING), None)
    for row in rows:
        area = row.area and (row.area.lut, row.area.ff, row.area.ram, row.area.dsp)
        table.add_row(
            row.target,
            TARGETS[row.target].kind,
            _mhz(row.worst_mhz),
            _mhz(row.median_mhz),
            f"{row.median_mhz / ceiling:.0%}" if row.median_mhz and ceiling else "",
            *map(str, area or [""] * 4),
            "" if row.lut_ratio is None else f"{row.lut_ratio:.2f}",
            _goal(row),
            MET[row.met],
        )
    return table


def _remarks(rows: Sequence[Row]) -> list[Text]:
    """Of one part: what it was placed with, and what failed."""
    seeds = min((len(row.fmax_mhz) for row in rows if not row.failed), default=0)
    few = f"; it takes seeds 1 to {SEEDS} to meet a goal" if seeds < SEEDS else ""
    lines = [f"{rows[0].part}, seeds 1 to {seeds}, behind registered pins{few}"] if seeds else []
    lines += [f"{row.target}: {row.failed}" for row in rows if row.failed]
    return [Text(line) for line in lines]


def _mhz(mhz: float | None) -> str:
    return "" if mhz is None else f"{mhz:.0f}"


def _goal(row: Row) -> str:
    """Of the worst seed, and of the median where there is one."""
    if row.goal is None:
        return ""
    median = "" if row.goal.median_mhz is None else f" / {row.goal.median_mhz:.0f}"
    return f"{row.goal.worst_mhz:.0f}{median}"
