"""VCD and FST as other programs write them, sound and damaged."""

import json
import os
import re
import signal
import subprocess
import sys
from dataclasses import asdict
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.waves import Limits, Trace, Waveform, read, write_vcd
from railgate.waves.wellen import CHILD, decode, read_wellen
from waves.drawn import assert_reads_or_is_refused, damaged

DATA = Path(__file__).parents[1] / "data" / "fst"
HEADER = """$date today $end
$timescale 10 us $end
$scope module t $end
$var wire 1 ! a $end
$var reg 4 " b [3:0] $end
$var integer 32 # i $end
$scope module u $end
$var wire 1 ! a $end
$var wire 65 % wide $end
$var real 64 & r $end
$var wire 1 ' c $end
$upscope $end
$upscope $end
$enddefinitions $end
"""
FIRST = "#0\n$dumpvars\n0!\nb1010 \"\nb0 #\nb0 %\nr0 &\n0'\n$end\n"


def written(folder: Path, text: str) -> Path:
    path = folder / "a.vcd"
    path.write_text(text)
    return path


def test_a_fst_reads_as_its_vcd_twin():
    fst, vcd = read(DATA / "wheel.fst"), read(DATA / "wheel.vcd")
    assert fst == vcd
    assert (fst.start, fst.period) == (0, Fraction(1, 10**8))
    assert list(fst.signals) == ["top.wheel.a", "top.wheel.b", "top.count"]
    assert fst["top.count"].values.tolist() == list(range(61))
    assert fst.end == fst["top.count"].ticks[-1] + 101
    assert read(DATA / "wheel.fst", ["count", "top.wheel.b"]) == Trace(
        {"count": fst["top.count"], "top.wheel.b": fst["top.wheel.b"]}, fst.period, 0, fst.end
    )


def test_every_signal_of_up_to_64_bits_is_taken(tmp_path):
    trace = decode(
        written(
            tmp_path, HEADER + FIRST + "#5\n1!\nb1 #\n#9\nb11111111111111111111111111111111 #\n"
        ),
        None,
        Limits(),
    )
    assert trace.period == Fraction(1, 100_000)
    assert (trace.start, trace.end) == (0, 10)
    assert trace.signals == {
        "t.a": Waveform.of([0, 5], [0, 1]),
        "t.b": Waveform.of([0], [10], 4),
        "t.i": Waveform.of([0, 5, 9], [0, 1, -1], 32, True),
        "t.u.a": Waveform.of([0, 5], [0, 1]),
        "t.u.c": Waveform.of([0], [0]),
    }


def test_a_trace_ends_after_the_last_time_stamp_with_or_without_changes(tmp_path):
    assert decode(written(tmp_path, HEADER + FIRST + "#5\n1!\n#77\n"), ["b"], Limits()).end == 78
    assert decode(written(tmp_path, HEADER + FIRST + "#5\n1!\n#78"), ["b"], Limits()).end == 79


def test_of_changes_at_one_time_the_last_counts(tmp_path):
    trace = decode(
        written(tmp_path, HEADER + FIRST + "#5\n1!\nx!\n0!\n1!\n#9\nx!\n0!\n"), ["t.a"], Limits()
    )
    assert trace["t.a"] == Waveform.of([0, 5, 9], [0, 1, 0])


def test_a_trace_begins_where_all_wanted_signals_are_known(tmp_path):
    path = written(tmp_path, HEADER + '#0\n0!\nbx "\n#3\nb10 "\n#5\n1!\nb11 "\n#9\n')
    both = decode(path, ["t.a", "b"], Limits())
    assert (both.start, both.end) == (3, 10)
    assert both["t.a"] == Waveform.of([3, 5], [0, 1])
    assert both["b"] == Waveform.of([3, 5], [2, 3], 4)
    assert decode(path, ["t.a"], Limits()).start == 0


@pytest.mark.parametrize(
    ("text", "channels", "reason"),
    [
        (
            HEADER + FIRST + "#5\nx!\n#6\n1!\n",
            ["t.a"],
            '"t.a" must stay known, not become x or z at 5e-05 s',
        ),
        (
            HEADER + FIRST + '#5\nb1z "\n',
            ["b"],
            '"b" must stay known, not become x or z at 5e-05 s',
        ),
        (HEADER + "#0\n0!\n", ["b"], '"b" must have a value of zeros and ones, it has none'),
        (HEADER + FIRST, ["wide"], '"wide" must be a signal of 1 to 64 bits, not 65 bits'),
        (HEADER + FIRST, ["r"], '"r" must be a signal of 1 to 64 bits, not Real'),
        (HEADER + FIRST, ["a"], '"a" must name one signal, not t.a, t.u.a'),
        (HEADER + FIRST, ["q"], 'no channel "q"; there are: t.a, t.b, t.i, t.u.a'),
        (HEADER + FIRST + "#5\n1!\n#4\n0!\n", None, "times must not run backwards, from 5 to 4"),
        (HEADER + FIRST + "#5 1! #3 0! #9 1!\n", None, "not run backwards, from 5 to 3"),
        (HEADER + FIRST + "#5\nb1\n#\n#3\n0!", None, "not run backwards, from 5 to 3"),
        (HEADER + "#-3\n0!\n", None, "times must not run backwards, from 0 to -3"),
        (HEADER + "#99999999999999999999\n0!\n", None, "too large"),
        (HEADER + "#9223372036854775807\n0!\n", ["t.a"], "must fit 64 bits"),
        (HEADER.replace("$timescale 10 us $end\n", "") + FIRST, None, "timescale must be stated"),
        (HEADER.replace("10 us", "7 parsec") + FIRST, None, "timescale must be stated"),
        (HEADER[:-25] + FIRST, None, "header must end with $enddefinitions"),
        (
            "$timescale 1 s $end\n$enddefinitions $end\n#0\n",
            None,
            "must hold a signal of 1 to 64 bits",
        ),
    ],
)
def test_what_cannot_be_read_is_refused(tmp_path, text, channels, reason):
    with pytest.raises((ValueError, OverflowError), match=re.escape(reason)):
        decode(written(tmp_path, text), channels, Limits())


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (HEADER + FIRST + "#5\n1!\n#4\n0!\n", "times must not run backwards, from 5 to 4"),
        (HEADER + FIRST + '#5\nb10q0 "\n', "invalid character"),
        (HEADER + FIRST + "#5\n1~\n", "index out of bounds"),
    ],
)
def test_panics_reach_the_caller_as_one_line(tmp_path, text, reason, capfd):
    path = written(tmp_path, text)
    with pytest.raises(ValueError, match=re.escape(reason)) as caught:
        read(path)
    assert "\n" not in str(caught.value)
    assert capfd.readouterr() == ("", "")


def test_an_undefined_signal_does_not_stop_the_others(tmp_path):
    path = written(tmp_path, HEADER + FIRST + "#5\nx!\n#6\n1!\n")
    assert decode(path, ["c", "b"], Limits()).end == 7


def test_times_off_the_noted_tick_are_refused(tmp_path):
    trace = Trace({"a": Waveform.of([0, 3], [0, 1])}, Fraction(1, 24_000_000), 0, 5)
    write_vcd(tmp_path / "a.vcd", trace)
    text = (tmp_path / "a.vcd").read_text().replace("#125000000", "#125000001")
    with pytest.raises(
        ValueError, match="times must be those of ticks that last 125000000/3 units"
    ):
        decode(written(tmp_path, text), None, Limits())


@pytest.mark.parametrize(
    ("limits", "reason"),
    [
        (Limits(signals=2), "must be at most 2 (limit signals)"),
        (Limits(transitions=120), "must be at most 120 (limit transitions), not 123"),
        (Limits(file_bytes=100), "(limit file_bytes)"),
    ],
)
def test_limits_are_kept(limits, reason):
    with pytest.raises(ValueError, match=re.escape(reason)):
        read(DATA / "wheel.fst", None, limits)


def test_a_file_that_asks_for_too_much_memory_is_refused(tmp_path, capfd):
    raw = bytearray((DATA / "wheel.fst").read_bytes())
    raw[722] = 151  # a length: pywellen asks for 20 GB and aborts its process
    (tmp_path / "a.fst").write_bytes(raw)
    with pytest.raises(ValueError, match="is damaged, or needs more than 8589934592 bytes"):
        read(tmp_path / "a.fst")
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("name", ["wheel.fst", "wheel.vcd"])
@given(data=st.data())
@settings(deadline=None, max_examples=6)
def test_a_damaged_file_reads_or_is_refused(tmp_path_factory, name, data):
    path = tmp_path_factory.mktemp("wellen") / name
    path.write_bytes(data.draw(damaged((DATA / name).read_bytes())))
    assert_reads_or_is_refused(path)


def test_only_time_stamps_are_time_stamps(tmp_path, monkeypatch):
    text = (
        "$timescale 1 us $end $scope module t $end\n"
        "$var wire 1 #2 a $end $var wire 4 #1 b $end $upscope $end $enddefinitions $end\n"
        "#10 0#2 b1010 #1\n$comment #4 and\n#3 $end #20 1#2 b11\n#1 #30 0#2"
    )
    for block in (1, 7, 1 << 22):
        monkeypatch.setattr("railgate.waves.wellen.BLOCK_BYTES", block)
        trace = decode(written(tmp_path, text), None, Limits())
        assert (trace.start, trace.end) == (10, 31)
        assert trace["t.a"] == Waveform.of([10, 20, 30], [0, 1, 0])
        assert trace["t.b"] == Waveform.of([10, 20], [10, 3], 4)


def test_reading_ends_in_time(tmp_path):
    os.mkfifo(tmp_path / "a.vcd")
    with pytest.raises(ValueError, match=re.escape("must take at most 1 s (limit seconds)")):
        read_wellen(tmp_path / "a.vcd", None, Limits(seconds=1))


def test_the_reading_process_ends_without_its_parent(tmp_path):
    path = written(tmp_path, "$enddefinitions $end\n")
    os.truncate(path, 1 << 33)
    limits = Limits(seconds=1, metadata_bytes=1 << 32)
    order = {"path": str(path), "result": "", "channels": None, "limits": asdict(limits)}
    done = subprocess.run(
        [sys.executable, "-P", "-c", CHILD],
        input=json.dumps(order),
        text=True,
        timeout=30,
        check=False,
    )
    assert done.returncode == -signal.SIGXCPU


def test_a_packed_fst_is_refused(tmp_path):
    (tmp_path / "a.fst").write_bytes(b"\xfe" + (DATA / "wheel.fst").read_bytes())
    with pytest.raises(ValueError, match="must not be packed"):
        read(tmp_path / "a.fst")
