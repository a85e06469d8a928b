"""A run of the vital output as files: its events as Parquet and CSV, waves as VCD, pictures."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from railgate.records import tables, write_folder
from railgate.vital_output.diagram import draw_states
from railgate.vital_output.picture import draw
from railgate.vital_output.simulate import Run
from railgate.waves import write_gtkw, write_vcd

__all__ = ["record"]

EVENT = ("t_s", "source", "what")
CLOSING = ("output", "closed_s", "opened_s", "opened_by", "live_s", "since_live_s", "safe")


def record(run: Run, folder: Path) -> list[Path]:
    """Write all files into `folder`, see `write_folder`; returns their paths. Raises ValueError."""
    told = run.as_json()
    events, closings = (
        {name: [row[name] for row in told[rows]] for name in names}
        for rows, names in (("events", EVENT), ("closings", CLOSING))
    )
    return write_folder(
        folder,
        {
            **tables("events", events),
            **tables("closings", closings),
            "vital.vcd": lambda path: write_vcd(path, run.waves),
            "vital.gtkw": lambda path: write_gtkw(path, "vital.vcd", run.waves),
            "vital.png": partial(draw, run),
            "states.png": partial(draw_states, run),
        },
    )
