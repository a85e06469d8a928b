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
    """A line for each target, its clock beside the ceiling of the same part, then what failed."""
    table = Table(header_style="bold")
    for name in ("target", "kind"):
        table.add_column(name, no_wrap=True)
    names = ("worst MHz", "median MHz", "of ceiling", "LUT", "FF", "RAM", "DSP", "goal MHz")
    for name in names:
        table.add_column(name, justify="right")
    table.add_column("goal")
    ceilings = {row.part: row.median_mhz for row in rows if row.target == CEILING}
    for row in rows:
        area = row.area and (row.area.lut, row.area.ff, row.area.ram, row.area.dsp)
        table.add_row(
            row.target,
            TARGETS[row.target].kind,
            _mhz(row.worst_mhz),
            _mhz(row.median_mhz),
            _share(row.median_mhz, ceilings.get(row.part)),
            *map(str, area or [""] * 4),
            _goal(row),
            MET[row.met],
        )
    return Group(table, *map(Text, _remarks(rows)))


def _remarks(rows: Sequence[Row]) -> list[str]:
    seeds = min((len(row.fmax_mhz) for row in rows if not row.failed), default=0)
    few = f"; it takes seeds 1 to {SEEDS} to meet a goal" if seeds < SEEDS else ""
    parts = ", ".join(dict.fromkeys(row.part for row in rows))
    lines = [f"{parts}, seeds 1 to {seeds}, behind registered pins{few}"] if seeds else []
    return lines + [f"{row.target}: {row.failed}" for row in rows if row.failed]


def _mhz(mhz: float | None) -> str:
    return "" if mhz is None else f"{mhz:.0f}"


def _share(mhz: float | None, ceiling: float | None) -> str:
    return f"{mhz / ceiling:.0%}" if mhz is not None and ceiling else ""


def _goal(row: Row) -> str:
    """Of the worst seed, and of the median where there is one."""
    if row.goal is None:
        return ""
    median = "" if row.goal.median_mhz is None else f" / {row.goal.median_mhz:.0f}"
    return f"{row.goal.worst_mhz:.0f}{median}"
