"""A result as a folder of files."""

from __future__ import annotations

import csv
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet

from railgate.waves import replacing

__all__ = ["Columns", "tables", "write_folder"]

Columns = Mapping[str, Sequence[object]]
"""A table, name -> one value a row: a number, a text, None, or a list of texts."""


def write_folder(folder: Path, writers: Mapping[str, Callable[[Path], None]]) -> list[Path]:
    """Let each writer write its file into `folder`, made where missing; returns the paths.

    writers: by the file's name; each is given its path and leaves there the whole file or nothing.
    Raises ValueError where the folder cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, write in writers.items():
            write(folder / name)
    except OSError as error:
        raise ValueError(f"{folder} cannot be written: {error.strerror}") from None
    return [folder / name for name in writers]


def tables(name: str, columns: Columns) -> dict[str, Callable[[Path], None]]:
    """The writers of one table as `<name>.parquet` and `<name>.csv`."""
    return {f"{name}.parquet": partial(_parquet, columns), f"{name}.csv": partial(_csv, columns)}


def _parquet(columns: Columns, path: Path) -> None:
    with replacing(path) as new:
        pyarrow.parquet.write_table(pa.table(dict(columns)), new)


def _csv(columns: Columns, path: Path) -> None:
    """A list is written as its texts with blanks between, None as nothing."""
    with replacing(path) as new, new.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        for row in zip(*columns.values(), strict=True):
            writer.writerow(" ".join(v) if isinstance(v, list | tuple) else v for v in row)
