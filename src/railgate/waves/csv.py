"""CSV captures: Saleae Logic 2's digital export, and any table of that shape.

The first line names the columns; the first column is the time in seconds, each other column a
channel of integers. A row holds from its time until the next row's; Saleae writes one only where
a channel changes, and negative times before its trigger.
Ref: Saleae's "Logic 2 Capture Format", digital CSV export.
"""

from __future__ import annotations

import csv
import math
from collections import Counter
from collections.abc import Iterator, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.csv as pacsv
from numpy.typing import NDArray

from railgate.waves.limits import Limits
from railgate.waves.trace import Trace, absent
from railgate.waves.waveform import Ticks, Waveform

__all__ = ["read_csv"]

DECIMALS = (9, 12, 15, 18)
"""Places after the point of a time that are tried; the fewest that hold all times are taken."""
BLOCK_BYTES = 1 << 22
FIRST_ROW = 2


def read_csv(path: Path, channels: Sequence[str] | None, limits: Limits) -> Trace:
    """The channels of a CSV capture.

    Contract: railgate.waves.files.read. A tick is the greatest common divisor of all times, that
    is the capture's grid as far as its times show it; every time is an exact multiple of it, and
    `start` is negative where the first time is. The trace ends one tick after the last row. A
    channel's width is that of its greatest value, signed where one is negative. Of rows with
    equal times the last counts.
    """
    header = _header(path, limits)
    there = header[1:]
    names = there if channels is None else channels
    known = set(there)
    for name in names:
        if name not in known:
            raise absent(name, there)
    for decimals in DECIMALS:
        rows = _Rows(names, limits)
        try:
            for batch in _batches(path, header, names, decimals):
                rows.add(batch)
        except pa.ArrowInvalid:
            if decimals == DECIMALS[-1]:
                raise
        else:
            return rows.trace(Fraction(1, 10**decimals))
    raise AssertionError("the last resolution either raises or returns")


def _header(path: Path, limits: Limits) -> list[str]:
    with path.open(encoding="utf-8-sig", newline="") as file:
        line = file.readline(limits.metadata_bytes + 1)
    limits.check("metadata_bytes", len(line), "the length of line 1")
    header = [name.strip() for name in next(csv.reader([line]), [])]
    if len(header) < 2:
        raise ValueError("line 1 must name the time and at least one channel")
    limits.check("signals", len(header) - 1, "the number of columns")
    if "" in header or all(_is_number(name) for name in header):
        raise ValueError(f'line 1 must name every column, not hold "{line.strip()[:40]}"')
    twice, times = Counter(header).most_common(1)[0]
    if times > 1:
        raise ValueError(f'each column needs its own name, not twice "{twice}"')
    return header


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _batches(
    path: Path, header: list[str], names: Sequence[str], decimals: int
) -> Iterator[pa.RecordBatch]:
    types: dict[str, pa.DataType] = {name: pa.int64() for name in names}
    with pacsv.open_csv(
        path,
        read_options=pacsv.ReadOptions(
            use_threads=False, block_size=BLOCK_BYTES, column_names=header, skip_rows=1
        ),
        convert_options=pacsv.ConvertOptions(
            column_types={header[0]: pa.decimal128(38, decimals), **types},
            include_columns=[header[0], *names],
            null_values=[],
        ),
    ) as reader:
        yield from reader


class _Rows:
    """Collects the rows at which each channel changes, times as integers."""

    def __init__(self, names: Sequence[str], limits: Limits) -> None:
        self.limits = limits
        self.times: dict[str, list[Ticks]] = {name: [] for name in names}
        self.values: dict[str, list[NDArray[np.int64]]] = {name: [] for name in names}
        self.first: int | None = None
        self.last = 0
        self.grid = 0
        self.read = 0
        self.kept = 0

    def add(self, batch: pa.RecordBatch) -> None:
        if not batch.num_rows:
            return
        times = self._checked_times(batch.column(0))
        for index, name in enumerate(self.times):
            values = batch.column(index + 1).to_numpy()
            before = self.values[name][-1][-1] if self.values[name] else ~values[0]
            changes = np.append(values[0] != before, values[1:] != values[:-1])
            if changes.any():
                self.times[name].append(times[changes])
                self.values[name].append(values[changes])
                self.kept += int(np.count_nonzero(changes))
        self.limits.check("transitions", self.kept, "the number of transitions")
        self.grid = math.gcd(self.grid, int(np.gcd.reduce(times)))
        self.last = int(times[-1])
        self.read += times.size

    def _checked_times(self, column: Any) -> Ticks:
        words = np.frombuffer(column.buffers()[1], "<i8").reshape(-1, 2)
        words = words[column.offset : column.offset + len(column)]
        times, beyond = words[:, 0], words[:, 1] != words[:, 0] >> 63
        if beyond.any():
            row = FIRST_ROW + self.read + int(np.argmax(beyond))
            raise ValueError(f"line {row}: the time has too many digits for 64 bits")
        if self.first is None:
            self.first = self.last = int(times[0])
        falls = np.diff(times, prepend=self.last) < 0
        if falls.any():
            row = FIRST_ROW + self.read + int(np.argmax(falls))
            raise ValueError(f"line {row}: times must not run backwards")
        return np.ascontiguousarray(times)

    def trace(self, resolution: Fraction) -> Trace:
        """The trace; where every time is 0, a tick is the resolution of the times."""
        if self.first is None:
            raise ValueError("the file must hold at least one row, not only line 1")
        grid = self.grid or 1
        signals = {}
        for name, times in self.times.items():
            values = np.concatenate(self.values.pop(name))
            ticks = np.concatenate(times) // grid
            times.clear()
            low, high = int(values.min()), int(values.max())
            width = max(max(high, 0).bit_length(), max(~low, 0).bit_length()) + (low < 0)
            signals[name] = Waveform.of(ticks, values, max(width, 1), low < 0)
        return Trace(signals, grid * resolution, self.first // grid, self.last // grid + 1)
