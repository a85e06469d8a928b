"""A measurement as files: windows as Parquet and CSV, waves as VCD, a picture."""

from __future__ import annotations

from dataclasses import fields
from functools import partial
from pathlib import Path

from railgate.odometer.measure import Measurement, Window
from railgate.odometer.picture import draw
from railgate.records import tables, write_folder
from railgate.waves import write_gtkw, write_vcd

__all__ = ["record"]


def record(measurement: Measurement, folder: Path) -> list[Path]:
    """Write all files into `folder`, see `write_folder`; returns their paths. Raises ValueError."""
    names = [field.name for field in fields(Window)]
    windows = {name: [getattr(window, name) for window in measurement.windows] for name in names}
    waves = measurement.gateware
    return write_folder(
        folder,
        {
            **tables("windows", windows),
            "gateware.vcd": lambda path: write_vcd(path, waves),
            "gateware.gtkw": lambda path: write_gtkw(path, "gateware.vcd", waves),
            "speed.png": partial(draw, measurement),
        },
    )
