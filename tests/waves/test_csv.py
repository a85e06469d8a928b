"""CSV captures: exact times, Saleae's export, and every way to be damaged."""

import math
import re
import time
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.waves import Limits, Trace, Waveform, read
from waves.drawn import assert_reads_or_is_refused, damaged

SALEAE = """Time [s],Channel 0,Channel 1
-0.000000500,0,1
0.000000000,1,1
0.000000125,0,0
0.000001000,1,0
"""


def written(folder: Path, text: str | bytes) -> Path:
    path = folder / "a.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def test_an_export_of_logic_2_reads_with_its_negative_times(tmp_path):
    trace = read(written(tmp_path, SALEAE))
    assert trace.period == Fraction(1, 8_000_000)
    assert (trace.start, trace.end) == (-4, 9)
    assert trace["Channel 0"] == Waveform.of([-4, 0, 1, 8], [0, 1, 0, 1])
    assert trace["Channel 1"] == Waveform.of([-4, 1], [1, 0])


@given(st.data())
@settings(deadline=None, max_examples=80)
def test_every_row_is_read_exactly(tmp_path_factory, data):
    digits = data.draw(st.integers(0, 18))
    largest = min(
        10**9 * 10**digits, (1 << 63) // 10 ** max(0, math.ceil(digits / 3) * 3 - digits) // 2
    )
    units = data.draw(st.lists(st.integers(-largest, largest), min_size=1, max_size=12))
    units.sort()
    columns = data.draw(
        st.lists(
            st.lists(
                st.one_of(st.integers(0, 1), st.integers(-(1 << 63), (1 << 63) - 1)),
                min_size=len(units),
                max_size=len(units),
            ),
            min_size=1,
            max_size=3,
        )
    )
    header = ",".join(["t", *(f"c{i}" for i in range(len(columns)))])
    rows = [
        ",".join([f"{Decimal(unit).scaleb(-digits):f}", *map(str, values)])
        for unit, *values in zip(units, *columns, strict=True)
    ]
    trace = read(written(tmp_path_factory.mktemp("csv"), "\n".join([header, *rows])))
    times = [Fraction(unit, 10**digits) for unit in units]
    assert all((time / trace.period).denominator == 1 for time in times)
    assert trace.start * trace.period == times[0]
    assert (trace.end - 1) * trace.period == times[-1]
    ticks = [int(time / trace.period) for time in times]
    if any(ticks):
        assert math.gcd(*ticks) == 1
    for index, values in enumerate(columns):
        last = dict(zip(ticks, values, strict=True))
        assert trace[f"c{index}"].at(list(last)).tolist() == list(last.values())


def test_a_channel_is_as_wide_as_its_values(tmp_path):
    trace = read(written(tmp_path, "t,a,b,c,d,e\n0,0,7,-1,-8,-8\n1,0,8,0,7,-8\n"))
    kinds = {name: (wave.width, wave.signed) for name, wave in trace.signals.items()}
    assert kinds == {
        "a": (1, False),
        "b": (4, False),
        "c": (1, True),
        "d": (4, True),
        "e": (4, True),
    }


def test_rows_of_several_blocks_are_one_signal(tmp_path):
    rows = "".join(f"{tick}e-6,{tick // 2 & 1}\n" for tick in range(500_000))
    trace = read(written(tmp_path, "t,a\n" + rows))
    assert trace["a"].ticks.tolist() == list(range(0, 500_000, 2))
    assert trace.period == Fraction(1, 1_000_000)


def test_channels_wanted_come_in_their_order(tmp_path):
    path = written(tmp_path, "\ufeffTime , a, b \r\n0 , 0, 1\r\n1, 1, 1\r\n\r\n")
    assert list(read(path, ["b", "a"]).signals) == ["b", "a"]


def refused(path: Path, reason: str, channels=None, limits=None) -> None:
    with pytest.raises(ValueError, match=re.escape(reason)) as caught:
        read(path, channels, limits)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "line 1 must name the time and at least one channel"),
        ("t\n1\n", "line 1 must name the time and at least one channel"),
        ("t,,a\n1,0,0\n", "line 1 must name every column"),
        ("0,1\n1,0\n", 'line 1 must name every column, not hold "0,1"'),
        ("t,a,a\n1,0,0\n", 'each column needs its own name, not twice "a"'),
        ("t,a\n", "at least one row"),
        ("t,a\n0,1\n1\n", "Row #3: Expected 2 columns, got 1"),
        ("t,a\n0,1\n1,0,0\n", "Row #3: Expected 2 columns, got 3"),
        ("t,a\n0,1\n5,0\n4,1\n", "line 4: times must not run backwards"),
        ("t,a\n0,1\nnan,0\n", "Row #3: The string 'nan' is not a valid decimal128 number"),
        ("t,a\ninf,1\n", "Row #2: The string 'inf' is not a valid decimal128 number"),
        ("t,a\n,1\n", "Row #2: Empty string cannot be converted to decimal128"),
        ("t,a\n0,\n", "Row #2: CSV conversion error to int64: invalid value ''"),
        ("t,a\n0,x\n", "Row #2: CSV conversion error to int64: invalid value 'x'"),
        ("t,a\n0,0.5\n", "invalid value '0.5'"),
        ("t,a\n0,nan\n", "invalid value 'nan'"),
        ("t,a\n0.0000000000000000001,1\n", "Rescaling Decimal value would cause data loss"),
        ("t,a\n0,1\n10000000000,1\n", "line 3: the time has too many digits for 64 bits"),
        (b"t,\xff\n0,1\n", "invalid start byte"),
    ],
)
def test_damaged_tables_are_refused(tmp_path, text, reason):
    refused(written(tmp_path, text), reason)


def test_limits_and_missing_channels_are_named(tmp_path):
    path = written(tmp_path, SALEAE)
    refused(path, 'no channel "x"; there are: Channel 0, Channel 1', ["x"])
    refused(path, "at most 5 (limit transitions), not 6", limits=Limits(transitions=5))
    refused(path, "at most 1 (limit signals), not 2", limits=Limits(signals=1))
    refused(path, "(limit metadata_bytes)", limits=Limits(metadata_bytes=9))
    refused(path, "(limit file_bytes)", limits=Limits(file_bytes=9))
    refused(tmp_path / "b.csv", "no such file")


def test_a_table_of_one_instant_has_the_resolution_as_tick(tmp_path):
    trace = read(written(tmp_path, "t,a\n0,1\n0,0\n"))
    assert trace == Trace({"a": Waveform.of([0], [0])}, Fraction(1, 10**9), 0, 1)


@given(st.data())
@settings(deadline=None, max_examples=150)
def test_a_damaged_table_reads_or_is_refused(tmp_path_factory, data):
    content = data.draw(damaged(SALEAE.encode()))
    assert_reads_or_is_refused(written(tmp_path_factory.mktemp("csv"), content))


def test_many_columns_take_linear_time(tmp_path):
    names = [f"c{index}" for index in range(20_000)]
    path = written(tmp_path, ",".join(["t", *names]) + "\n")
    began = time.process_time()
    refused(path, 'no channel "x"', [*names, "x"])
    refused(written(tmp_path, ",".join(["t", *names, names[-1]])), 'not twice "c19999"')
    assert time.process_time() - began < 1
