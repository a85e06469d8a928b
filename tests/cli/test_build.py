"""`railgate build`."""

import json
import re
from pathlib import Path

import pytest

from railgate.fpga.boards import BOARDS
from railgate.fpga.gateware.top import TARGETS


@pytest.mark.slow
@pytest.mark.shows("SYS-3")
def test_a_bitstream_and_its_facts_are_written(railgate) -> None:
    call = ("build", "position_link", "--board", "ulx3s-25f", "--seed", "2")
    code, out, err = railgate(*call)
    assert (code, err) == (0, "")
    bitstream = Path("build/boards/position_link-ulx3s-25f.bit")
    facts = json.loads(bitstream.with_suffix(".json").read_text("utf-8"))
    for shown in (facts["sha256"], "seed 2", "clock sync", "40 MHz, reaches", f"wrote {bitstream}"):
        assert shown in out
    assert f"openFPGALoader -b ulx3s {bitstream}" in out
    code, out, err = railgate(*call, "--json")
    assert (code, json.loads(out), err) == (0, facts, "")


def test_what_cannot_be_placed_is_one_line_and_exit_code_1(railgate) -> None:
    code, out, err = railgate("build", "odometer", "--board", "icebreaker", "--limit", "1ms")
    assert (code, out) == (1, "")
    assert err == "railgate: yosys was not done in 0.001 s\n"
    assert not list(Path("build/boards").iterdir())
    told = railgate("build", "fpga_1", "--board", "icebreaker")
    assert told == (1, "", "railgate: fpga_1 must take at most 1 PLL of iCE40-UP5K, not 2\n")


def test_boards_and_targets_are_listed(railgate) -> None:
    code, out, err = railgate("build", "--list")
    assert (code, err) == (0, "")
    for name in (*BOARDS, *TARGETS):
        assert name in out
    code, out, err = railgate("build", "--list", "--json")
    assert (code, err) == (0, "")
    told = {each["board"]: each for each in json.loads(out)}
    assert told.keys() == BOARDS.keys()
    assert told["icebreaker"]["fits"] == list(BOARDS["icebreaker"].fits)
    assert told["tang-nano-9k"]["part"] == "GW1NR-9"


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("odometer",), "TARGET and --board must be given, or --list"),
        (("wheel", "--board", "icebreaker"), 'a target must be one of odometer, .*, not "wheel"'),
        (("odometer", "--board", "versa"), 'a board must be one of ulx3s-25f, .*, not "versa"'),
        (("odometer", "--board", "icebreaker", "--unit", "tram"), "unit must be one of metro"),
        (("odometer", "--board", "icebreaker", "--seed", "-1"), "seed must be between 0"),
        (("odometer", "--board", "icebreaker", "--limit", "0s"), "--limit must be above 0 s"),
        (("odometer", "--board", "icebreaker", "--pins", "none.toml"), "none.toml: No such file"),
        (("odometer", "--board", "icebreaker", "--out", "/dev/null/x"), "cannot be written"),
    ],
)
def test_a_wrong_input_is_one_clear_line_and_exit_code_2(railgate, arguments, says) -> None:
    code, out, err = railgate("build", *arguments)
    assert (code, out) == (2, "")
    assert err.count("\n") == 1
    assert re.search(says, err)
