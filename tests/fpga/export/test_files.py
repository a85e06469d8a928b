"""What is written: the same each time, and wholly or not at all."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from railgate.fpga.export import FORMATS, core, export, files

FILES = {
    "verilog": {"v", "vlt", "sdc", "xdc", "lpf"},
    "rtlil": {"il"},
    "systemrdl": {"rdl"},
    "c-header": {"h"},
}


def content(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.mark.parametrize("format", FILES)
def test_each_format_has_its_files(tmp_path, format) -> None:
    paths = export(core("position_link"), format, tmp_path)
    assert {path.name for path in paths} == {f"railgate_position_link.{s}" for s in FILES[format]}
    assert set(tmp_path.iterdir()) == set(paths)
    assert all(path.stat().st_size for path in paths)


def test_another_process_with_other_hashes_writes_the_same_bytes(exported, tmp_path) -> None:
    made = exported("odometer")
    program = (
        "from pathlib import Path; from railgate.fpga.export import core, export; "
        "export(core('odometer'), 'core', Path('again'))"
    )
    subprocess.run(
        [sys.executable, "-c", program],
        cwd=tmp_path,
        env=os.environ | {"PYTHONHASHSEED": "4711"},
        check=True,
        capture_output=True,
    )
    assert content(tmp_path / "again") == content(made.path.parent)


def test_what_fails_leaves_what_was_there(tmp_path, monkeypatch) -> None:
    of = core("position_link")
    export(of, "verilog", tmp_path)
    before = content(tmp_path)

    def fails(*_: object) -> None:
        raise ValueError("out of luck")

    monkeypatch.setattr(files, "_constraints", fails)
    with pytest.raises(ValueError, match="out of luck"):
        export(of, "verilog", tmp_path)
    assert content(tmp_path) == before


def test_pages_take_the_place_of_older_ones(tmp_path) -> None:
    of = core("unit", fpga=2)
    (pages,) = export(of, "html", tmp_path)
    (pages / "stale.html").touch()
    assert export(of, "html", tmp_path) == [pages]
    assert (pages / "index.html").exists()
    assert not (pages / "stale.html").exists()


def test_a_core_on_a_bus_brings_its_registers(exported) -> None:
    told = exported("position_link", "axi4-lite").text(".rdl")
    assert "addrmap position_link {" in told


def test_the_formats_are_those_that_are_told() -> None:
    assert set(FORMATS) == {*FILES, "core", "html"}
