"""`simulate link` and `decode`: what they print, what they write, how they fail."""

import json
import re
import sys
from fractions import Fraction
from pathlib import Path
from unittest.mock import patch

import pyarrow.parquet
import pytest

from railgate.cli import main
from railgate.position_link.host import layout_file
from railgate.position_link.spec import Cause
from railgate.waves import read, write_parquet

DOCS = (Path(__file__).parents[2] / "docs" / "commands.md").read_text(encoding="utf-8")
EXAMPLE = str(Path(layout_file.__file__).with_name("example.toml"))
SIMULATE = ("simulate", "link", "--seconds", "0.2s")
FAULTS = ("--fault", "missing@20ms", "--fault", "short@60ms..119ms", "--fault", "bit-error:9@160ms")
LINE = ("--clk", "clk", "--uef", "uef", "--data", "data")


@pytest.fixture(scope="module")
def captured(tmp_path_factory) -> Path:
    """A line with a missing answer, three short ones and a wrong bit, as a VCD."""
    folder = tmp_path_factory.mktemp("link")
    arguments = ["railgate", *SIMULATE, *FAULTS, "--out", str(folder)]
    with patch.object(sys, "argv", arguments), pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 0
    return folder


def test_simulate_shows_each_cycle_and_what_was_wrong(railgate) -> None:
    code, out, _ = railgate(*SIMULATE, *FAULTS)
    assert code == 0
    rows = [line.split() for line in out.splitlines() if re.match(r" ?0\.\d{6} ", line)]
    assert [row[2] for row in rows] == (
        ["fresh", "held", "fresh", "held", "held", "fault", "fresh", "fresh", "held", "fresh"]
    )
    assert "timeout" in rows[1]
    assert all("short" in row for row in rows[3:6])
    assert rows[5][1] == "f" * 16
    assert "check" in rows[8]
    assert "5 fresh, 4 held, 1 fault words" in out


def test_the_json_object_is_as_documented(railgate) -> None:
    code, out, _ = railgate(*SIMULATE, *FAULTS, "--json")
    result = json.loads(out)
    assert code == 0
    page = DOCS.split("## railgate simulate link")[1].split("## railgate decode")[0]
    documented = set(re.findall(r"`(\w+)`", " ".join(re.findall(r"^\| (`.*?) \|", page, re.M))))
    assert result.keys() | result["cycles"][0].keys() <= documented
    assert result["causes"].keys() <= documented
    assert [cycle["number"] for cycle in result["cycles"]] == list(range(1, 11))
    assert {cycle["tick"] % 800_000 for cycle in result["cycles"]} == {7444}
    assert (result["fresh"], result["held"], result["fault"]) == (5, 4, 1)
    assert result["causes"] == {c.name.lower(): 0 for c in Cause} | {
        "timeout": 1,
        "short": 3,
        "check": 1,
    }
    assert result["radio_frames"] == 10
    assert result["cycles"][5]["values"] == {}
    positions = [cycle["values"]["position"] for cycle in result["cycles"] if cycle["values"]]
    assert positions == sorted(positions)


def test_leap_and_the_compiled_closed_loop_print_the_same_object(railgate) -> None:
    results = []
    for engine in ("leap", "cxxrtl"):
        _, out, _ = railgate(*SIMULATE, *FAULTS, "--engine", engine, "--json")
        results.append({**json.loads(out), "engine": ""})
    assert results[0] == results[1]


def test_the_interpreted_closed_loop_prints_the_same_object(railgate) -> None:
    """A slow clock and a short cycle, since pysim takes its time."""
    small = ("--clock", "1MHz", "--bit-rate", "100kHz", "--cycle", "2ms", "--filter", "2")
    faults = ("--guard", "1", "--seconds", "10ms", "--fault", "long@4ms", "--fault", "noise@6ms")
    results = []
    for engine in ("leap", "pysim"):
        _, out, _ = railgate("simulate", "link", *small, *faults, "--engine", engine, "--json")
        results.append({**json.loads(out), "engine": ""})
    assert results[0] == results[1]


def test_out_writes_tables_waves_and_a_picture(captured) -> None:
    names = {"cycles.parquet", "cycles.csv", "link.vcd", "link.gtkw", "link.png"}
    assert {path.name for path in captured.iterdir()} == names
    rows = pyarrow.parquet.read_table(captured / "cycles.parquet")
    assert rows.num_rows == 10
    assert rows["value.position"].null_count == 1
    waves = read(captured / "link.vcd", ["clk", "anf", "delivery", "radio.frames"])
    assert waves["clk"].rising().size == 10 * 10_240
    assert waves["anf"].rising().size == waves["delivery"].rising().size == 10
    assert waves["radio.frames"].values[-1] == 10
    assert (captured / "link.png").read_bytes().startswith(b"\x89PNG")


def test_decode_reads_words_and_faults_of_a_captured_line(railgate, captured) -> None:
    vcd = str(captured / "link.vcd")
    code, out, _ = railgate("decode", vcd, *LINE, "--anf", "anf", "--layout", EXAMPLE, "--json")
    result = json.loads(out)
    assert code == 0
    page = DOCS.split("## railgate decode")[1].split("\n## ")[0]
    assert result.keys() | result["answers"][0].keys() <= set(re.findall(r"`(\w+)`", page))
    assert result["bit_rate_hz"] == pytest.approx(512_000, rel=1e-6)
    assert [answer["causes"] for answer in result["answers"]] == (
        [[], ["timeout"], [], ["short"], ["short"], ["short"], [], [], ["check"], []]
    )
    sent = [
        row["word"] for row in pyarrow.parquet.read_table(captured / "cycles.parquet").to_pylist()
    ]
    told = [answer["word"] for answer in result["answers"]]
    assert [told[i] for i in (0, 2, 6, 7, 9)] == [sent[i] for i in (0, 2, 6, 7, 9)]
    assert (result["good"], result["cut"], result["requests"]) == (5, 0, True)


def test_decode_does_without_requests_and_takes_a_coarser_capture(
    railgate, captured, tmp_path
) -> None:
    """As a logic analyser of 24 MHz would have it, with names of its own."""
    line = read(captured / "link.vcd", ["clk", "uef", "data"]).resample(Fraction(1, 24_000_000))
    path, out_folder = tmp_path / "line.parquet", tmp_path / "out"
    write_parquet(path, line.rename({"clk": "D0", "uef": "D1", "data": "D2"}))
    channels = ("--clk", "D0", "--uef", "D1", "--data", "D2")
    options = ("--layout", EXAMPLE, "--out", str(out_folder))
    code, out, _ = railgate("decode", str(path), *channels, *options)
    assert code == 0
    assert "UEF alone, no ANF" in out
    assert "5 (1 timeout, 3 short, 1 check)" in out
    names = {"answers.parquet", "answers.csv", "line.vcd", "line.gtkw"}
    assert {path.name for path in out_folder.iterdir()} == names


def test_a_capture_without_an_answer_gives_an_empty_table(railgate, captured, tmp_path) -> None:
    idle = read(captured / "link.vcd", ["clk", "uef", "data"]).slice(8_000, 700_000)
    write_parquet(tmp_path / "idle.parquet", idle)
    folder = tmp_path / "out"
    code, out, _ = railgate("decode", str(tmp_path / "idle.parquet"), *LINE, "--out", str(folder))
    assert code == 0
    assert "good words  0" in out
    assert (folder / "answers.csv").read_text().split() == ["t_s,uef_s,bits,word,causes"]
    assert pyarrow.parquet.read_table(folder / "answers.parquet").num_rows == 0


def test_a_line_may_be_faster_than_the_filter_of_a_link_allows(railgate, captured) -> None:
    options = ("--bit-rate", "2MHz", "--cycle", "100us", "--anf", "anf", "--json")
    code, out, _ = railgate("decode", str(captured / "link.vcd"), *LINE, *options)
    assert code == 0
    assert json.loads(out)["good"] == 6


def test_an_hour_is_shown_in_a_few_rows(railgate) -> None:
    code, out, _ = railgate("simulate", "link", "--seconds", "3600", "--fault", "missing@1800s")
    rows = [line for line in out.splitlines() if re.match(r" *\d+\.\d{6} ", line)]
    assert code == 0
    assert len(rows) == 5
    assert "… 89998 alike …" in out


def test_other_words_are_sent_and_read_without_a_layout(railgate) -> None:
    options = ("--word-bits", "128", "--check", "crc:16:0x1021:0xffff", "--fault-word", "0x0")
    code, out, _ = railgate(*SIMULATE, *options, "--fault", "fault-word@100ms", "--json")
    result = json.loads(out)
    assert code == 0
    assert result["word_bits"] == 128
    assert len(result["cycles"][0]["word"]) == 34
    assert result["causes"]["fault_word"] == 1
    assert result["cycles"][0]["values"] == {}


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--fault", "gone@1s"), "a fault must be one of missing, short, long, early"),
        (("--fault", "missing"), "a fault must be KIND@TIME"),
        (("--fault", "missing@9s"), "missing must begin before the run's end at 0.2 s, not at 9 s"),
        (("--bit-rate", "512001Hz"), "the nearest are 512000 and 512050, not 512001"),
        (("--clock", "0.5Hz"), "--clock must be a whole number of Hz, not 0.5Hz"),
        (("--word-bits", "4"), "word_bits must be between 8 and 512, not 4"),
        (("--check", "crc8"), "--check must be none, even, odd or crc:WIDTH:POLY"),
        (("--check", "crc:8:0x1ff"), "polynomial must be between 1 and 255, not 511"),
        (("--fault-word", "ones"), "--fault-word must be a number as 0xffff, not 'ones'"),
        (("--layout", "none.toml"), "none.toml"),
        (("--layout", EXAMPLE, "--word-bits", "32"), "--layout says what --word-bits says"),
        (("--engine", "steam"), "leap, cxxrtl, pysim"),
        (("--seconds", "0s"), "cycles must be between 1 and"),
        (("--latency", "20000"), "latency"),
        (("--waves", "1001"), "less than or equal to 1000"),
        (("--out", "/dev/null/x"), "cannot be written"),
    ],
)
def test_a_bad_simulation_is_one_clear_line_and_exit_code_2(railgate, arguments, says) -> None:
    refused(railgate(*SIMULATE, *arguments), says)


def test_a_bad_decoding_is_one_clear_line_and_exit_code_2(railgate, captured) -> None:
    vcd = str(captured / "link.vcd")
    refused(railgate("decode", "none.vcd", *LINE), "none.vcd: no such file")
    refused(railgate("decode", vcd, *LINE[:4], "--data", "dta"), 'no channel "dta"; there are: clk')
    refused(railgate("decode", vcd, *LINE[:4], "--data", "clk"), "must be different channels")
    refused(
        railgate("decode", vcd, *LINE[:4], "--data", "word"), '"data" must be 1 bit wide, not 64'
    )
    refused(railgate("decode", vcd, *LINE, "--filter", "-1"), "filter_ticks must be between 0")


def refused(result: tuple[int, str, str], says: str) -> None:
    code, out, err = result
    assert code == 2
    assert out == ""
    assert says in err
    assert err.startswith("railgate: ")
    assert err.count("\n") == 1
