"""`fpga report`."""

import json
import re
from pathlib import Path

import pytest

QUICK = ("fpga", "report", "lfsr", "--seeds", "1")


def test_a_table_and_a_file_tell_what_a_target_reaches(railgate) -> None:
    code, out, err = railgate(*QUICK)
    assert (code, err) == (0, "")
    told = json.loads(Path("build/fpga.json").read_text("utf-8"))
    assert [row["target"] for row in told] == ["lfsr"]
    clock = told[0]["fmax_worst_mhz"]
    assert 400 < clock < 700
    for shown in ("lfsr", "ceiling", "ECP5-25F-6", f"{clock:.0f}", "100%", "32"):
        assert shown in out
    assert "it takes seeds 1 to 5 to meet a goal" in out
    assert "wrote build/fpga.json" in out
    code, out, err = railgate(*QUICK, "--json")
    assert (code, json.loads(out), err) == (0, told, "")


def test_a_target_that_cannot_be_placed_is_told_and_the_exit_code_is_1(railgate) -> None:
    code, out, err = railgate(*QUICK, "--limit", "1ms", "--out", "elsewhere")
    assert (code, err) == (1, "")
    assert "lfsr: yosys was not done in 0.001 s" in out
    assert json.loads(Path("elsewhere/fpga.json").read_text("utf-8"))[0]["failed"]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("wheel",), 'a target must be one of lfsr, .*, not "wheel"'),
        (("--part", "ECP4"), 'a part must be one of ECP5-25F-6, iCE40-HX8K, .*, not "ECP4"'),
        (("--limit", "0s"), "--limit must be above 0 s, not 0s"),
        (("--limit", "soon"), "a number with s, ms"),
        (("--seeds", "0"), "--seeds"),
        (("--out", "/dev/null/x"), "/dev/null/x/fpga.* cannot be written"),
    ],
)
def test_a_wrong_input_is_one_clear_line_and_exit_code_2(railgate, arguments, says) -> None:
    code, out, err = railgate("fpga", "report", *arguments)
    assert (code, out) == (2, "")
    assert err.count("\n") == 1
    assert re.search(says, err)
