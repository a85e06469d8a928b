"""A run's files: all that was known, and what it takes to run it again."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pyarrow.parquet
import pytest

from railgate.unit import record as recording
from railgate.unit.log import Log
from railgate.unit.record import record
from railgate.unit.result import Result
from railgate.unit.scenario_file import read_scenario
from railgate.waves import read

FILES = {
    "report.html",
    "run.json",
    "cycles.parquet",
    "events.parquet",
    "events.csv",
    "events.jsonl",
    "scenario.toml",
}


@pytest.fixture(scope="module")
def folder(result: Result, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("runs") / "new" / "run"
    paths = record(result, folder)
    assert paths[0].name == "report.html"
    assert all(path.is_file() for path in paths)
    return folder


def test_the_folder_has_all_files_and_nothing_else(folder: Path, result: Result) -> None:
    assert {path.name for path in folder.iterdir()} == {*FILES, "waves"}
    numbers = [f"{n + 1:03}" for n in range(len(result.excerpts.spans))]
    names = {f"{number}.{suffix}" for number in numbers for suffix in ("vcd", "gtkw")}
    assert {path.name for path in (folder / "waves").iterdir()} == names


def test_every_column_of_every_cycle_is_in_the_table(folder: Path, result: Result) -> None:
    table, cycles = pyarrow.parquet.read_table(folder / "cycles.parquet"), result.run.cycles
    columns = sum(int(np.prod(column.shape[1:])) for column in vars(cycles).values())
    assert table.num_columns == columns
    for name, column in (
        ("times_s", cycles.times_s),
        ("low_kmh_2", cycles.low_kmh[:, 1]),
        ("verdicts_1_2", cycles.verdicts[:, 0, 1]),
        ("image", cycles.image),
    ):
        assert np.array_equal(table[name].to_numpy(), column)


def test_tables_log_and_json_tell_the_same_events(folder: Path, result: Result) -> None:
    told = json.loads((folder / "run.json").read_text("utf-8"))
    assert told == json.loads(json.dumps(result.as_json()))
    rows = pyarrow.parquet.read_table(folder / "events.parquet").to_pylist()
    assert rows == told["events"]
    with Log(folder / "events.jsonl") as log:
        assert log.events == result.events


def test_each_events_waves_show_what_was_at_its_time(folder: Path) -> None:
    """The relay's opening, for one, is where the event is."""
    events = json.loads((folder / "run.json").read_text("utf-8"))["events"]
    for name in {each["waves"] for each in events if "contact" in each["what"]}:
        waves = read(folder / "waves" / f"{name}.vcd")
        start, end = (float(time * waves.period) for time in (waves.start, waves.end))
        falls = waves["contact"].falling() * float(waves.period)
        for each in (each for each in events if each["waves"] == name):
            assert start <= each["time_s"] <= end
            if "contact opens" in each["what"]:
                assert np.abs(falls - each["time_s"]).min() < 1e-6


def test_a_viewer_is_told_what_to_show_together(folder: Path) -> None:
    shown = (folder / "waves" / "001.gtkw").read_text("utf-8")
    assert '[dumpfile] "001.vcd"' in shown
    for title in ("wheel sensors", "position link", "FPGA 1", "FPGA 2", "relay"):
        assert title in shown


def test_the_scenario_can_be_run_again_from_the_folder(folder: Path, result: Result) -> None:
    assert (folder / "scenario.toml").read_text("utf-8") == result.text
    assert read_scenario(folder / "scenario.toml") == result.run.scenario


def test_a_run_takes_the_place_of_the_one_before_and_leaves_the_users_files(
    result: Result, tmp_path: Path
) -> None:
    waves = tmp_path / "waves"
    waves.mkdir()
    for name in ("999.vcd", "999.gtkw", "mine.vcd"):
        (waves / name).write_text("")
    (tmp_path / "notes.txt").write_text("")
    record(result, tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {*FILES, "waves", "notes.txt"}
    assert not (waves / "999.vcd").exists()
    assert not (waves / "999.gtkw").exists()
    assert (waves / "mine.vcd").exists()


def test_one_that_is_interrupted_leaves_no_report_and_nothing_half_written(
    result: Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "report.html").write_text("of a run before")

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(recording, "write_vcd", interrupted)
    with pytest.raises(KeyboardInterrupt):
        record(result, tmp_path)
    assert [path.name for path in tmp_path.rglob("*") if path.is_file()] == []


def test_a_folder_that_cannot_be_written_is_one_line_of_error(
    result: Result, tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ValueError, match="cannot be written"):
        record(result, tmp_path / "file" / "run")
