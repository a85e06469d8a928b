"""A run of the link as files: its cycles as Parquet and CSV, its waves as VCD, a picture."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import Any

from railgate.position_link.decode import Decoded
from railgate.position_link.host import Layout
from railgate.position_link.picture import draw
from railgate.position_link.simulate import Run
from railgate.records import Columns, tables, write_folder
from railgate.waves import write_gtkw, write_vcd

__all__ = ["record", "record_decoded"]

CYCLE = (
    *("tick", "t_s", "number", "word", "status", "age", "age_s", "health"),
    *("causes", "consistent"),
)
ANSWER = ("t_s", "uef_s", "bits", "word", "causes")


def record(run: Run, folder: Path) -> list[Path]:
    """Write all files into `folder`, see `write_folder`; returns their paths. Raises ValueError."""
    return write_folder(
        folder,
        {
            **tables("cycles", _columns(CYCLE, run.as_json()["cycles"], run.deliveries.layout)),
            "link.vcd": lambda path: write_vcd(path, run.waves),
            "link.gtkw": lambda path: write_gtkw(path, "link.vcd", run.waves),
            "link.png": partial(draw, run),
        },
    )


def record_decoded(found: Decoded, folder: Path) -> list[Path]:
    """Write a captured line's answers and waves, as `record` does. Raises ValueError."""
    line = found.line.shift(-found.line.start)
    return write_folder(
        folder,
        {
            **tables("answers", _columns(ANSWER, found.as_json()["answers"], found.layout)),
            "line.vcd": lambda path: write_vcd(path, line),
            "line.gtkw": lambda path: write_gtkw(path, "line.vcd", line),
        },
    )


def _columns(names: Iterable[str], rows: list[dict[str, Any]], layout: Layout | None) -> Columns:
    """What the JSON object has of each row; the layout's values are columns of their own."""
    columns = {name: [row[name] for row in rows] for name in names}
    fields = layout.fields if layout else ()
    values = {f"value.{f.name}": [row["values"].get(f.name) for row in rows] for f in fields}
    return columns | values
