"""A run of the link as files: its cycles as Parquet and CSV, its waves as VCD, a picture."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from railgate.position_link.picture import draw
from railgate.position_link.simulate import Run
from railgate.records import Columns, tables, write_folder
from railgate.waves import write_gtkw, write_vcd

__all__ = ["record"]


def record(run: Run, folder: Path) -> list[Path]:
    """Write all files into `folder`, see `write_folder`; returns their paths. Raises ValueError."""
    return write_folder(
        folder,
        {
            **tables("cycles", _columns(run)),
            "link.vcd": lambda path: write_vcd(path, run.waves),
            "link.gtkw": lambda path: write_gtkw(path, "link.vcd", run.waves),
            "link.png": partial(draw, run),
        },
    )


def _columns(run: Run) -> Columns:
    """What the JSON object has of each cycle; the layout's values are columns of their own."""
    rows = run.as_json()["cycles"]
    columns = {name: [row[name] for row in rows] for name in rows[0] if name != "values"}
    values = {
        f"value.{name}": [row["values"].get(name) for row in rows] for name in run.deliveries.values
    }
    return columns | values
