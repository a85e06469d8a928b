"""Traces in Parquet, as one long table that pandas, polars and duckdb read as it is.

Columns: `signal` (string, dictionary-coded), `tick` (int64), `value` (int64; decimal128(20, 0)
only where a signal holds values beyond 2⁶³ - 1). One row is one step: the signal holds `value`
from `tick` on. Rows stand signal by signal, ticks rising. The file's metadata under the key
`railgate` hold, as JSON, what the rows do not: `period` (seconds per tick, a fraction), `start`,
`end`, and `signals` (name, width, signed) in their order.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from railgate.waves.limits import Limits
from railgate.waves.replacing import replacing
from railgate.waves.trace import Trace, absent
from railgate.waves.waveform import Ticks, Values, Waveform

__all__ = ["read_parquet", "write_parquet"]

KEY = b"railgate"
ROWS = 1 << 20
WIDE = pa.decimal128(20, 0)
PERIOD = re.compile(r"[0-9]{1,40}(?:/[0-9]{1,40})?")


def write_parquet(path: str | Path, trace: Trace) -> None:
    """Writes the trace so that `read` gives an equal one. Raises ValueError if it cannot."""
    if not PERIOD.fullmatch(str(trace.period)):
        raise ValueError(f"a period must be a fraction of 40 digits at most, not {trace.period}")
    wide = any(int(wave.values.max()) >> 63 > 0 for wave in trace.signals.values())
    about = {
        "period": str(trace.period),
        "start": trace.start,
        "end": trace.end,
        "signals": [
            {"name": name, "width": wave.width, "signed": wave.signed}
            for name, wave in trace.signals.items()
        ],
    }
    schema = pa.schema(
        {
            "signal": pa.dictionary(pa.int32(), pa.string()),
            "tick": pa.int64(),
            "value": WIDE if wide else pa.int64(),
        },
        metadata={KEY: json.dumps(about, ensure_ascii=False).encode()},
    )
    with replacing(path) as unfinished, pq.ParquetWriter(unfinished, schema) as writer:
        for name, wave in trace.signals.items():
            for first in range(0, len(wave), ROWS):
                part = slice(first, first + ROWS)
                writer.write_batch(_batch(schema, name, wave.ticks[part], wave.values[part]))


def _batch(schema: pa.Schema, name: str, ticks: Ticks, values: Values) -> pa.RecordBatch:
    named = pa.DictionaryArray.from_arrays(np.zeros(ticks.size, np.int32), pa.array([name]))
    return pa.record_batch(
        [named, pa.array(ticks), pa.array(values).cast(schema.field("value").type)], schema=schema
    )


def read_parquet(path: Path, channels: Sequence[str] | None, limits: Limits) -> Trace:
    """The signals of a file that `write_parquet` wrote.

    Contract: railgate.waves.files.read. A table without its metadata says neither how long a tick
    is nor where the trace ends, and is refused.
    """
    with pq.ParquetFile(
        path,
        read_dictionary=["signal"],  # a name is decoded once, not once a row
        memory_map=False,
        thrift_string_size_limit=limits.metadata_bytes,
        thrift_container_size_limit=limits.metadata_bytes,
    ) as file:
        about = (file.schema_arrow.metadata or {}).get(KEY)
        if about is None:
            raise ValueError(
                "a Parquet file must carry this program's metadata (period, start, end, signals)"
            )
        limits.check("metadata_bytes", len(about), "the size of the metadata in bytes")
        period, start, end, kinds = _about(json.loads(about))
        limits.check("signals", len(kinds), "the number of signals")
        names = list(kinds) if channels is None else channels
        for name in names:
            if name not in kinds:
                raise absent(name, list(kinds))
        _check_columns(file.schema_arrow)
        steps = _steps(file, {name: kinds[name][1] for name in names}, limits)
    signals = {}
    for name in names:
        if name not in steps:
            raise ValueError(f'signal "{name}" must have at least one row, not none')
        width, signed = kinds[name]
        ticks, values = (np.concatenate(column) for column in steps.pop(name))
        signals[name] = Waveform(ticks, values, width, signed)
    return Trace(signals, period, start, end)


def _about(about: dict[str, Any]) -> tuple[Fraction, int, int, dict[str, tuple[int, bool]]]:
    try:
        kinds = {str(s["name"]): (int(s["width"]), bool(s["signed"])) for s in about["signals"]}
        period, start, end = (about[key] for key in ("period", "start", "end"))
        if not PERIOD.fullmatch(period) or type(start) is not int or type(end) is not int:
            raise TypeError(f"{period!r:.50}, {start!r:.50}, {end!r:.50}")
        return Fraction(period), start, end, kinds
    except (KeyError, TypeError, ZeroDivisionError) as error:
        raise ValueError(f"the metadata are damaged: {error!r}") from error


def _check_columns(schema: pa.Schema) -> None:
    for name, what in (("signal", "strings"), ("tick", "integers"), ("value", "integers")):
        if name not in schema.names:
            raise ValueError(f"there must be a column {name}, not only {', '.join(schema.names)}")
        kind = schema.field(name).type
        held = kind.value_type if isinstance(kind, pa.DictionaryType) else kind
        sound = {
            "strings": pa.types.is_string(held),
            "integers": pa.types.is_integer(kind) or (name == "value" and kind == WIDE),
        }
        if not sound[what]:
            raise ValueError(f"column {name} must hold {what}, not {kind}")


def _steps(
    file: pq.ParquetFile, signs: Mapping[str, bool], limits: Limits
) -> dict[str, tuple[list[Ticks], list[Values]]]:
    """Ticks and values of the signals wanted, `signs` telling which of them are signed."""
    steps: dict[str, tuple[list[Ticks], list[Values]]] = {}
    kept = inflated = 0
    for batch in file.iter_batches(ROWS, columns=["signal", "tick", "value"]):
        inflated += batch.nbytes
        if any(column.null_count for column in batch.columns):
            raise ValueError("the table must hold no nulls")
        limits.check("inflated_bytes", inflated, "the size of the table in bytes")
        for name, rows in _runs(batch):
            if name in signs:
                ticks, values = steps.setdefault(name, ([], []))
                ticks.append(rows.column(1).to_numpy())
                values.append(_integers(rows.column(2), signs[name]))
                kept += rows.num_rows
                limits.check("transitions", kept, "the number of transitions")
    return steps


def _runs(batch: pa.RecordBatch) -> Iterator[tuple[str, pa.RecordBatch]]:
    """The batch in pieces of one signal each."""
    column: Any = batch.column(0)
    if not pa.types.is_dictionary(column.type):
        column = column.dictionary_encode()
    codes = column.indices.to_numpy()
    names = column.dictionary.to_pylist()
    begins = np.flatnonzero(np.diff(codes, prepend=-1)).tolist()
    for begin, stop in zip(begins, [*begins[1:], codes.size], strict=True):
        yield names[codes[begin]], batch.slice(begin, stop - begin)


def _integers(column: Any, signed: bool) -> Values:
    if pa.types.is_decimal(column.type):
        column = column.cast(pa.int64() if signed else pa.uint64())
    values: Values = column.to_numpy()
    return values
