"""Synthesis, place and route, and what is kept of them. The real tools run, on small designs."""

import json
from collections import Counter
from dataclasses import replace
from pathlib import Path

import pytest

from railgate.fpga.flow import Flow, cells, fmax_mhz
from railgate.fpga.gateware import Lfsr, Sources, Ssi, netlist
from railgate.fpga.parts import PARTS, REFERENCE, Area, part
from railgate.fpga.tools import UnplacedError

KEPT = Path(__file__).parent / "kept"
"""What Yosys and nextpnr wrote of the target crc32."""

LIMIT_S = 300.0
"""The first run of a tool compiles it."""


def flow(folder: Path, component=Lfsr, limit_s: float = LIMIT_S, on: str = REFERENCE) -> Flow:
    return Flow("small", Sources(netlist(component())), on, folder, limit_s)


def changed(monkeypatch, **now) -> None:
    monkeypatch.setitem(PARTS, REFERENCE, replace(PARTS[REFERENCE], **now))


def test_cells_are_read_of_each_module() -> None:
    told = json.loads((KEPT / "cells.json").read_text("utf-8"))
    assert cells(told) == {
        "top.component": Counter(LUT4=136, PFUMX=14, TRELLIS_FF=32),
        "top": Counter(LUT4=31, TRELLIS_FF=76),
    }


def test_the_clock_is_read_of_a_report() -> None:
    told = json.loads((KEPT / "report.json").read_text("utf-8"))
    assert fmax_mhz(told) == pytest.approx(241.25, abs=0.01)


@pytest.mark.parametrize("clocks", [0, 2])
def test_a_report_without_one_clock_is_refused(clocks) -> None:
    told = {"fmax": {f"clk{n}": {"achieved": 100.0} for n in range(clocks)}}
    with pytest.raises(ValueError, match=f"one clock, not of {clocks}"):
        fmax_mhz(told)


LEAST_MHZ = {"iCE40-UP5K": 50}
"""Of a small design; on all other parts 300."""


@pytest.mark.parametrize("on", [name for name, each in PARTS.items() if each.free_pins])
def test_a_small_design_gets_its_figures_and_its_pins_are_not_in_its_area(tmp_path, on) -> None:
    made = flow(tmp_path, on=on)
    taken = made.synthesise()
    assert taken.inside.ff == 32
    assert taken.whole.ff == 32 + 2 + 2 * 32  # the reset's, and two of each output
    assert 1 <= taken.inside.lut <= 32
    assert LEAST_MHZ.get(on, 300) < made.place(1) < 700


def test_what_is_kept_is_not_made_again(tmp_path) -> None:
    first = flow(tmp_path)
    figures = first.synthesise(), first.place(1)
    no_time = flow(tmp_path, limit_s=1e-3)
    assert (no_time.synthesise(), no_time.place(1)) == figures
    with pytest.raises(UnplacedError, match=r"^nextpnr-ecp5 was not done in 0\.001 s$"):
        no_time.place(2)
    assert [path.name for path in tmp_path.glob("*/*seed*")] == ["seed-1.json"]


def test_another_design_is_not_taken_for_the_one_that_is_kept(tmp_path) -> None:
    flow(tmp_path).synthesise()
    with pytest.raises(UnplacedError, match=r"^yosys was not done in 0\.001 s$"):
        flow(tmp_path, Ssi, 1e-3).synthesise()
    assert len(list(tmp_path.iterdir())) == 1  # nothing half-made


@pytest.mark.parametrize("what", ["lut", "ff"])
def test_a_part_that_is_too_small_is_told(tmp_path, monkeypatch, what) -> None:
    taken = flow(tmp_path).synthesise().whole
    changed(monkeypatch, has=replace(PARTS[REFERENCE].has, **{what: getattr(taken, what)}))
    says = (
        rf"^small must take at most 75% of the \d+ {what.upper()} of ECP5-25F-6, not \d+ \(100%\)$"
    )
    with pytest.raises(UnplacedError, match=says):
        flow(tmp_path).place(1)


def test_an_error_of_a_tool_is_one_line(tmp_path, monkeypatch) -> None:
    changed(monkeypatch, options=("--25k", "--package", "NONE"))
    with pytest.raises(UnplacedError, match=r"^nextpnr-ecp5: .*NONE.*$"):
        flow(tmp_path).place(1)


def test_a_cell_that_nothing_is_known_of_is_told(tmp_path, monkeypatch) -> None:
    changed(monkeypatch, takes={"TRELLIS_FF": Area(ff=1)})
    with pytest.raises(ValueError, match="must be one of TRELLIS_FF, not LUT4"):
        flow(tmp_path).synthesise()


def test_a_folder_that_cannot_be_written_is_told() -> None:
    with pytest.raises(ValueError, match=r"^/dev/null/.* cannot be written"):
        flow(Path("/dev/null")).synthesise()


def test_a_tool_that_is_missing_is_told_with_the_remedy(tmp_path, monkeypatch) -> None:
    changed(monkeypatch, nextpnr="nowhere")
    with pytest.raises(
        ValueError, match=r"yowasp-nextpnr-nowhere is needed: install railgate\[fpga\]"
    ):
        flow(tmp_path)


def test_a_part_that_needs_pins_is_told(tmp_path) -> None:
    with pytest.raises(ValueError, match='iCE40-UP5K, not "GW1NR-9"'):
        flow(tmp_path, on="GW1NR-9")


def test_a_part_that_is_not_there_is_told() -> None:
    with pytest.raises(ValueError, match=r'one of ECP5-25F-6, iCE40-HX8K, .*, not "ECP4"'):
        part("ECP4")


def test_two_processes_may_make_the_same(tmp_path) -> None:
    first, second = flow(tmp_path), flow(tmp_path)
    taken = first.synthesise()
    second._make()
    assert second.synthesise() == taken
    assert len(list(tmp_path.iterdir())) == 1
