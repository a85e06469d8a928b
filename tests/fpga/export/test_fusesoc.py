"""The exported folder, as FuseSoC runs it."""

from __future__ import annotations

import re

import pytest

from fpga.export.judges import Core, needs_icarus, run


def fusesoc(made: Core, tmp_path, target: str, *options: str):
    command = ["fusesoc", "--cores-root", made.path.parent, "run", f"--target={target}"]
    return run([*command, f"railgate:cores:{made.name}", *options], tmp_path)


def test_it_lints(exported, tmp_path) -> None:
    result = fusesoc(exported("odometer"), tmp_path, "lint")
    assert result.returncode == 0, result.stdout
    assert re.search(r"^verilator -f ", result.stdout, re.M)
    assert "%Warning" not in result.stdout


@needs_icarus
def test_it_simulates_in_icarus(exported, tmp_path) -> None:
    result = fusesoc(exported("odometer"), tmp_path, "sim_icarus", "--ticks", "2000")
    assert result.returncode == 0, result.stdout
    assert "PASS: railgate_odometer, 2000 ticks" in result.stdout


@pytest.mark.slow
@pytest.mark.parametrize("target", ["odometer", "position_link", "vital_output"])
def test_it_simulates_in_verilator(exported, tmp_path, target) -> None:
    result = fusesoc(exported(target), tmp_path, "sim", "--ticks", "40000")
    assert result.returncode == 0, result.stdout
    assert re.search(r"PASS: railgate_\w+, 40000 ticks", result.stdout)


@needs_icarus
def test_it_fails_where_an_answer_differs(exported, tmp_path) -> None:
    made = exported("odometer")
    for path in made.path.parent.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    vectors = tmp_path / "railgate_odometer.vectors"
    text = vectors.read_text(encoding="utf-8")
    busy = re.search(r"(\d+): must_busy = ", made.text("_tb.sv"))[1]
    assert text.count(f"\n0 {busy} 0\n") == 1
    vectors.write_text(text.replace(f"\n0 {busy} 0\n", f"\n0 {busy} 1\n"), encoding="utf-8")
    result = fusesoc(Core(tmp_path), tmp_path, "sim_icarus", "--ticks", "2000")
    assert result.returncode != 0
    assert "tick 0: busy is 0, must be 1" in result.stdout


@pytest.mark.slow
def test_a_whole_fpga_lints_and_has_nothing_to_simulate(exported, tmp_path) -> None:
    made = exported("unit", "uart")
    assert fusesoc(made, tmp_path, "lint").returncode == 0
    assert fusesoc(made, tmp_path, "sim").returncode != 0
