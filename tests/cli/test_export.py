"""`railgate export`."""

from __future__ import annotations

import re
from pathlib import Path

import pytest


def test_it_tells_what_it_wrote(railgate) -> None:
    code, out, err = railgate("export", "position_link", "--format", "verilog", "--bus", "wishbone")
    assert (code, err) == (0, "")
    name = "railgate_position_link_wishbone"
    wrote = [f"wrote build/export/{name}.{suffix}" for suffix in ("lpf", "sdc", "v", "vlt", "xdc")]
    assert out.splitlines() == wrote
    text = Path(f"build/export/{name}.v").read_text(encoding="utf-8")
    assert f"\nmodule {name}(" in text
    assert "wb__stall" in text


def test_a_configuration_comes_from_a_file_or_a_unit(railgate) -> None:
    Path("mine.toml").write_text("sensors = 1\n", encoding="utf-8")
    for config, sensors in (("mine.toml", {0}), ("maglev", {0, 1})):
        code, _, err = railgate(
            "export", "odometer", "--config", config, "--format", "systemrdl", "--out", "."
        )
        assert (code, err) == (0, "")
        text = Path("railgate_odometer.rdl").read_text(encoding="utf-8")
        assert {n for n in range(3) if f"sensor_{n}_pulses" in text} == sensors


@pytest.mark.shows("SYS-1")
def test_the_map_of_the_unit_is_written_for_other_tools(railgate) -> None:
    for arguments in (("systemrdl",), ("c-header",), ("html", "--fpga", "2")):
        code, _, err = railgate("export", "unit", "--format", *arguments, "--out", "maps")
        assert (code, err) == (0, "")
    assert "addrmap fpga_1 {" in Path("maps/railgate_fpga_1.rdl").read_text(encoding="utf-8")
    assert "} fpga_1_t;" in Path("maps/railgate_fpga_1.h").read_text(encoding="utf-8")
    assert Path("maps/railgate_fpga_2_registers/index.html").exists()


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("wheel",), "a target must be one of odometer, position_link, vital_output, unit, not"),
        (("odometer", "--format", "vhdl"), "format must be one of verilog, rtlil, core, .* not"),
        (("odometer", "--bus", "can"), "bus must be one of none, axi4-lite, .*, uart, not"),
        (("vital_output", "--fpga", "3"), "fpga must be 1 or 2, not 3"),
        (("unit", "--config", "tram"), "config must be one of metro, maglev for the unit, not"),
        (("odometer", "--config", "tram"), "tram: No such file"),
        (("odometer", "--out", "/dev/null/x"), "/dev/null/x cannot be written"),
    ],
)
def test_a_wrong_input_is_one_clear_line_and_exit_code_2(railgate, arguments, says) -> None:
    code, out, err = railgate("export", *arguments)
    assert (code, out) == (2, "")
    assert err.count("\n") == 1
    assert re.search(says, err)
    assert not Path("build").exists()
