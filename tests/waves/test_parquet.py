"""Parquet: traces come back as they went, and damaged files are refused."""

import json
import re
from fractions import Fraction
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.waves import Limits, Trace, Waveform, read, write_parquet
from waves.drawn import assert_reads_or_is_refused, damaged, signals

SMALL = Trace(
    {"a": Waveform.of([-5, 3, 9], [0, 1, 0]), "b.c": Waveform.of([-5, 2], [-2, 1], 2, True)},
    Fraction(1, 24_000_000),
    -5,
    12,
)


@st.composite
def traces(draw):
    """Any trace: names, widths, signs, time bases, spans."""
    start = draw(st.integers(-(1 << 62), 1 << 62))
    end = start + draw(st.integers(0, 1000))
    names = draw(st.lists(st.text(min_size=0, max_size=5), max_size=4, unique=True))
    period = draw(
        st.fractions(Fraction(1, 1 << 80), 1 << 80).filter(
            lambda p: max(p.numerator, p.denominator) < 10**40
        )
    )
    return Trace(draw(signals(names, start, end)), period, start, end)


@given(traces())
@settings(deadline=None, max_examples=80)
def test_a_trace_comes_back_as_it_went(tmp_path_factory, trace):
    path = tmp_path_factory.mktemp("pq") / "a.parquet"
    write_parquet(path, trace)
    back = read(path)
    assert back == trace
    assert list(back.signals) == list(trace.signals)


def test_values_beyond_63_bits_come_back_across_batches(tmp_path):
    count = (1 << 20) + 5
    values = np.arange(count, dtype=np.uint64) + np.uint64((1 << 63) - (1 << 20))
    wave = Waveform(np.arange(count), values, 64)
    signed = Waveform.of([0, 1], [-1, 5], 64, True)
    trace = Trace({"a": wave, "b": signed}, Fraction(1), 0, count)
    write_parquet(tmp_path / "a.parquet", trace)
    assert read(tmp_path / "a.parquet") == trace


def test_the_table_is_plain_for_other_programs(tmp_path):
    write_parquet(tmp_path / "a.parquet", SMALL)
    table = pq.read_table(tmp_path / "a.parquet")
    assert table.column_names == ["signal", "tick", "value"]
    assert table["signal"].to_pylist() == ["a", "a", "a", "b.c", "b.c"]
    assert table["tick"].to_pylist() == [-5, 3, 9, -5, 2]
    assert table["value"].to_pylist() == [0, 1, 0, -2, 1]
    assert json.loads(table.schema.metadata[b"railgate"])["period"] == "1/24000000"


def test_channels_wanted_come_in_their_order(tmp_path):
    write_parquet(tmp_path / "a.parquet", SMALL)
    assert list(read(tmp_path / "a.parquet", ["b.c", "a"]).signals) == ["b.c", "a"]
    assert read(tmp_path / "a.parquet", ["a"]) == SMALL.select(["a"])


def refused(path: Path, reason: str, channels=None, limits=None) -> None:
    with pytest.raises(ValueError, match=re.escape(reason)) as caught:
        read(path, channels, limits)
    assert "\n" not in str(caught.value)


def foreign(path: Path, about: object = None, **columns: object) -> Path:
    table = pa.table({"signal": ["a", "a"], "tick": [0, 1], "value": [0, 1], **columns})
    if about is not None:
        table = table.replace_schema_metadata({b"railgate": json.dumps(about).encode()})
    pq.write_table(table, path)
    return path


ABOUT = {
    "period": "1/8",
    "start": 0,
    "end": 5,
    "signals": [{"name": "a", "width": 1, "signed": False}],
}


def test_a_table_that_another_program_wrote_with_the_metadata_reads(tmp_path):
    trace = read(foreign(tmp_path / "a.parquet", ABOUT))
    assert trace == Trace({"a": Waveform.of([0, 1], [0, 1])}, Fraction(1, 8), 0, 5)


@pytest.mark.parametrize(
    ("about", "columns", "reason"),
    [
        (None, {}, "must carry this program's metadata"),
        ({}, {}, "the metadata are damaged: KeyError('signals')"),
        ([], {}, "the metadata are damaged"),
        ({**ABOUT, "period": "1/0"}, {}, "the metadata are damaged: ZeroDivisionError"),
        ({**ABOUT, "period": "1e10000000"}, {}, "the metadata are damaged"),
        ({**ABOUT, "period": "1/" + "9" * 41}, {}, "the metadata are damaged"),
        ({**ABOUT, "period": 1}, {}, "the metadata are damaged"),
        ({**ABOUT, "end": 5.5}, {}, "the metadata are damaged"),
        ({**ABOUT, "end": "5"}, {}, "the metadata are damaged"),
        ({**ABOUT, "end": 1 << 63}, {}, "ticks must fit 64 bits"),
        ({**ABOUT, "period": "0"}, {}, "period must be above 0 s"),
        ({**ABOUT, "start": 1}, {}, "must begin at the trace's start, tick 1, not 0"),
        ({**ABOUT, "end": 1}, {}, "must end before the trace's end, tick 1, not 1"),
        (ABOUT, {"tick": [1, 0]}, "ticks must rise strictly, not go from 1 to 0"),
        (ABOUT, {"tick": [0, None]}, "must hold no nulls"),
        (ABOUT, {"value": [0, 2]}, "a value must be between 0 and 1, not 2"),
        (ABOUT, {"value": [0.0, 0.5]}, "column value must hold integers, not double"),
        (ABOUT, {"tick": ["x", "y"]}, "column tick must hold integers, not string"),
        (ABOUT, {"signal": ["b", "b"]}, 'signal "a" must have at least one row, not none'),
        (ABOUT, {"signal": [1, 2]}, "column signal must hold strings, not int64"),
    ],
)
def test_tables_that_are_no_trace_are_refused(tmp_path, about, columns, reason):
    refused(foreign(tmp_path / "a.parquet", about, **columns), reason)


def test_limits_and_missing_channels_are_named(tmp_path):
    path = tmp_path / "a.parquet"
    write_parquet(path, SMALL)
    refused(path, 'no channel "x"; there are: a, b.c', ["x"])
    refused(path, "(limit transitions)", limits=Limits(transitions=4))
    refused(path, "(limit signals)", limits=Limits(signals=1))
    refused(path, "(limit inflated_bytes)", limits=Limits(inflated_bytes=9))
    refused(path, "(limit file_bytes)", limits=Limits(file_bytes=9))
    refused(path, "Exceeded size limit", limits=Limits(metadata_bytes=50))


def test_a_place_that_cannot_be_written_is_refused(tmp_path):
    with pytest.raises(ValueError, match="cannot be written"):
        write_parquet(tmp_path / "none" / "a.parquet", SMALL)


@given(st.data())
@settings(deadline=None, max_examples=150)
def test_a_damaged_file_reads_or_is_refused(tmp_path_factory, data):
    path = tmp_path_factory.mktemp("pq") / "a.parquet"
    write_parquet(path, SMALL)
    path.write_bytes(data.draw(damaged(path.read_bytes())))
    assert_reads_or_is_refused(path)


def test_a_name_in_every_row_takes_memory_once(tmp_path):
    name, rows = "n" * 10_000, 1 << 12
    about = {**ABOUT, "end": rows, "signals": [{"name": name, "width": 1, "signed": False}]}
    table = pa.table(
        {
            "signal": [name] * rows,
            "tick": np.arange(rows),
            "value": np.arange(rows) % 2,
        }
    ).replace_schema_metadata({b"railgate": json.dumps(about).encode()})
    pq.write_table(table, tmp_path / "a.parquet")
    usual, pool = pa.default_memory_pool(), pa.proxy_memory_pool(pa.default_memory_pool())
    pa.set_memory_pool(pool)
    try:
        assert len(read(tmp_path / "a.parquet")[name]) == rows
    finally:
        pa.set_memory_pool(usual)
    assert 0 < pool.max_memory() < 8 << 20


def test_a_period_that_does_not_read_is_not_written(tmp_path):
    trace = Trace({}, Fraction(1, 10**40), 0, 5)
    with pytest.raises(ValueError, match="must be a fraction of 40 digits at most"):
        write_parquet(tmp_path / "a.parquet", trace)
    assert not list(tmp_path.iterdir())
