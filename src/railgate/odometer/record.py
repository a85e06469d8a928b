"""A measurement as files: windows as Parquet and CSV, waves as VCD, a picture."""

from __future__ import annotations

import csv
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet

from railgate.odometer.measure import Measurement, Window
from railgate.odometer.picture import draw
from railgate.waves import replacing, write_gtkw, write_vcd

__all__ = ["record"]


def record(measurement: Measurement, folder: Path) -> list[Path]:
    """Write all files into `folder`, made where missing; each is either whole or not there.

    Returns their paths. Raises ValueError where the folder cannot be written.
    """
    writers: dict[str, Callable[[Path], None]] = {
        "windows.parquet": lambda path: _parquet(measurement, path),
        "windows.csv": lambda path: _csv(measurement, path),
        "gateware.vcd": lambda path: write_vcd(path, measurement.gateware),
        "gateware.gtkw": lambda path: write_gtkw(path, "gateware.vcd", measurement.gateware),
        "speed.png": lambda path: _picture(measurement, path),
    }
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, write in writers.items():
            write(folder / name)
    except OSError as error:
        raise ValueError(f"{folder} cannot be written: {error.strerror}") from None
    return [folder / name for name in writers]


def _rows(measurement: Measurement) -> dict[str, list[object]]:
    names = [field.name for field in fields(Window)]
    return {name: [getattr(window, name) for window in measurement.windows] for name in names}


def _parquet(measurement: Measurement, path: Path) -> None:
    with replacing(path) as new:
        pyarrow.parquet.write_table(pa.table(_rows(measurement)), new)


def _picture(measurement: Measurement, path: Path) -> None:
    with replacing(path) as new:
        draw(measurement, new)


def _csv(measurement: Measurement, path: Path) -> None:
    columns = _rows(measurement)
    columns["flags"] = [" ".join(window.flags) for window in measurement.windows]
    with replacing(path) as new, new.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(zip(*columns.values(), strict=True))
