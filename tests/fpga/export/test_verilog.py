"""The Verilog, before those who read it."""

from __future__ import annotations

import re

import pytest

from fpga.export.judges import Core, needs_icarus, run
from railgate.fpga.export import BUSES, NONE, core, export

EVERY = [
    (target, bus)
    for target in ("odometer", "position_link", "vital_output", "unit")
    for bus in (NONE, *BUSES)
]
SOME = [("odometer", "none"), ("position_link", "axi4-lite")]


def linted(made: Core, *flags: str) -> None:
    result = run(["verilator", "--lint-only", "-Wall", *flags, *made.verilog], made.path.parent)
    assert result.returncode == 0, result.stdout
    assert "%Warning" not in result.stdout


def compiled(made: Core) -> None:
    result = run(
        ["iverilog", "-g2005", "-Wall", "-o", "/dev/null", made.file(".v")], made.path.parent
    )
    assert (result.returncode, result.stdout) == (0, "")


@pytest.mark.parametrize(("target", "bus"), SOME)
def test_verilator_has_nothing_to_warn_of(exported, target, bus) -> None:
    linted(exported(target, bus))


@needs_icarus
@pytest.mark.parametrize(("target", "bus"), SOME)
def test_icarus_takes_it_as_plain_verilog_without_a_warning(exported, target, bus) -> None:
    compiled(exported(target, bus))


@pytest.mark.slow
@needs_icarus
@pytest.mark.parametrize(("target", "bus"), EVERY)
def test_of_every_core_and_bus_neither_has_anything_to_say(exported, target, bus) -> None:
    linted(exported(target, bus))
    compiled(exported(target, bus))


def test_every_waiver_has_its_reason_and_no_other_file(exported) -> None:
    made = exported("odometer")
    lines = [line for line in made.text(".vlt").splitlines() if line]
    assert lines[0] == "`verilator_config"
    reasons, waivers = lines[1::2], lines[2::2]
    assert all(re.fullmatch(r"// .{20,}", reason) for reason in reasons)
    assert all(
        re.fullmatch(r'lint_off -rule [A-Z]+ -file "\*railgate_odometer\.v"', waiver)
        for waiver in waivers
    )
    assert len(reasons) == len(waivers) > 3


def test_what_is_not_waived_is_still_found(exported, tmp_path) -> None:
    made = exported("odometer")
    text = made.text(".v")
    broken = text.replace(
        "endmodule", "wire [3:0] undriven_; wire used_ = ^undriven_;\nendmodule", 1
    )
    (tmp_path / "railgate_odometer.v").write_text(broken, encoding="utf-8")
    command = ["verilator", "--lint-only", "-Wall", made.file(".vlt"), "railgate_odometer.v"]
    result = run(command, tmp_path)
    assert result.returncode != 0
    assert "UNDRIVEN" in result.stdout


@pytest.mark.shows("SYS-5")
def test_its_head_tells_version_licence_configuration_digest_and_every_port(exported) -> None:
    text = exported("odometer").text(".v")
    head = text[: text.index("\nmodule ")]
    of = core("odometer")
    config = of.configurations["odometer"]
    for told in (
        "// railgate_odometer: ",
        "// railgate 0.1.0, Amaranth ",
        "// SPDX-License-Identifier: Apache-2.0",
        f"// Digest of the configuration: odometer 0x{config.digest:08x}",
        f"//   clock_hz = {config.clock_hz}",
        "//   sensor__0__a: in, 1, asynchronous\n",
        "//   strobe: in, 1, sync_clk\n",
        "//   sensor__1__sum_b: out, 57, sync_clk, Σ of the running sum_a, ticks",
        "strobe: in, 1 bit, latches all sensors.",
    ):
        assert told in head
    top = text.partition("\nmodule railgate_odometer(")[2].partition(");")[0]
    ports = {name.strip(" \n\\") for name in top.split(",")}
    documented = re.findall(r"^//   (\w+): (?:in|out), \d+, ", head, re.M)
    assert len(documented) == len(set(documented))
    assert set(documented) == ports


def test_nothing_tells_of_the_machine_it_was_made_on(exported, tmp_path) -> None:
    made = exported("odometer")
    export(core("odometer"), "rtlil", tmp_path)
    for path in (*made.path.parent.iterdir(), *tmp_path.iterdir()):
        text = path.read_text(encoding="utf-8")
        assert not re.search(r"/(work|home|tmp|usr|root)\b|\.py\b|\bsrc = ", text), path
