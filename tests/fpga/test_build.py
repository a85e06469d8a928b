"""Bitstreams, by the real tools; what does not fit or is too slow is told, and leaves nothing."""

import json
import re
from dataclasses import replace
from hashlib import sha256
from pathlib import Path

import pytest

from railgate.fpga.boards import BOARDS
from railgate.fpga.build import STEPS, Built, build, plan, reached
from railgate.fpga.gateware.top import TARGETS, Top
from railgate.fpga.parts import PARTS, Area
from railgate.fpga.tools import UnplacedError
from railgate.position_link.spec import Config
from railgate.unit.config import UNITS, Unit

CASES = [(target, on) for on in BOARDS for target in TARGETS]
TWICE = [
    ("fpga_1", "ulx3s-25f"),
    *(("position_link", on) for on, each in BOARDS.items() if "position_link" in each.fits),
]


FAST = {"ulx3s-25f": 400_000_000, "icebreaker": 240_000_000, "tang-nano-9k": 240_000_000}
"""Clocks that the PLLs make, and no part's fabric reaches, Hz."""


def with_link_of(hz: int) -> type[Unit]:
    """A unit whose link has another clock."""

    class Fast(Unit):
        @property
        def link(self) -> Config:
            return replace(super().link, clock_hz=hz)

    return Fast


def facts_of(built: Built, target: str, on: str) -> None:
    """They are of this bitstream, and every clock is reached."""
    facts = json.loads(built.told.read_text("utf-8"))
    assert facts["sha256"] == sha256(built.bitstream.read_bytes()).hexdigest()
    assert (facts["target"], facts["board"], facts["seed"]) == (target, on, 1)
    assert facts["clocks"]
    for clock in facts["clocks"]:
        assert clock["mhz"] in (16, 40)
        assert clock["fmax_mhz"] >= clock["mhz"]
    assert len(list(built.bitstream.parent.iterdir())) == 2


@pytest.mark.slow
@pytest.mark.shows("SYS-3")
@pytest.mark.parametrize(("target", "on"), TWICE)
def test_a_bitstream_is_the_same_wherever_it_is_built(tmp_path, target, on) -> None:
    steps = []
    first = build(target, on, folder=tmp_path / "one", begins=steps.append)
    second = build(target, on, folder=tmp_path / "other" / "place")
    assert tuple(steps) == STEPS
    assert first.bitstream.read_bytes() == second.bitstream.read_bytes()
    assert first.told.read_bytes() == second.told.read_bytes()
    facts_of(first, target, on)


@pytest.mark.slow
@pytest.mark.shows("SYS-3")
@pytest.mark.parametrize(
    ("target", "on"), [c for c in CASES if c[0] in BOARDS[c[1]].fits and c not in TWICE]
)
def test_what_fits_a_board_is_built(tmp_path, target, on) -> None:
    facts_of(build(target, on, folder=tmp_path), target, on)


@pytest.mark.slow
@pytest.mark.shows("SYS-3")
@pytest.mark.parametrize(("target", "on"), [c for c in CASES if c[0] not in BOARDS[c[1]].fits])
def test_what_does_not_fit_a_board_is_told_and_leaves_nothing(tmp_path, target, on) -> None:
    with pytest.raises(UnplacedError) as told:
        build(target, on, folder=tmp_path, limit_s=300)  # some fit by area, and are not placed
    assert "\n" not in str(told.value)
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
@pytest.mark.shows("SYS-3")
@pytest.mark.parametrize(("on", "hz"), FAST.items())
def test_an_impossible_clock_fails_on_each_board(tmp_path, monkeypatch, on, hz) -> None:
    monkeypatch.setitem(UNITS, "fast", with_link_of(hz))
    says = rf"position_link on {on}: the clock sync must reach {hz / 1e6:g} MHz, not .*% less$"
    with pytest.raises(UnplacedError, match=says):
        build("position_link", on, unit="fast", folder=tmp_path)
    assert not list(tmp_path.iterdir())


PLL = {"ulx3s": "EHXPLLL", "hx8k": "SB_PLL40_CORE", "icebreaker": "SB_PLL40_PAD", "tang": "rPLL"}


@pytest.mark.parametrize("on", BOARDS)
def test_the_tools_are_told_of_all_pins_and_the_pll(on) -> None:
    pins, files = plan(Top(Unit(), "position_link"), on, None)
    netlist, constraints = files.values()
    told = constraints.decode()
    for pin in pins:
        for package in pin.package:
            assert re.search(rf'"?{"_".join(pin.path)}_0__io"?.* "?{package}"?\b', told)
    (primitive,) = (name for board, name in PLL.items() if on.startswith(board))
    assert len(re.findall(rf"cell \\{primitive} ", netlist.decode())) == 1


def test_a_part_that_is_too_small_is_told_before_it_is_placed(tmp_path, monkeypatch) -> None:
    small = replace(PARTS["iCE40-UP5K"], has=Area(lut=2000, ff=5280, ram=30))
    monkeypatch.setitem(PARTS, "iCE40-UP5K", small)
    steps = []
    says = r"^position_link must take at most 75% of the 2000 LUT of iCE40-UP5K, not \d+ \(\d+%\)$"
    with pytest.raises(UnplacedError, match=says):
        build("position_link", "icebreaker", folder=tmp_path, begins=steps.append)
    assert steps == list(STEPS[:2])
    assert not list(tmp_path.iterdir())


def test_a_tool_that_takes_too_long_is_told_and_leaves_nothing(tmp_path) -> None:
    with pytest.raises(UnplacedError, match=r"^yosys was not done in 0\.001 s$"):
        build("position_link", "icebreaker", folder=tmp_path, limit_s=1e-3)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("constraint", "net", "says"),
    [
        (12.0, "clk", r"must place for a clock clk or .* of 16 MHz, not for clk of 12 MHz$"),
        (16.0, "link_clk", r"a clock clk or .* of 16 MHz, not for link_clk of 16 MHz$"),
    ],
)
def test_a_clock_that_was_not_constrained_is_no_clock(constraint, net, says) -> None:
    report = {"fmax": {net: {"achieved": 100.0, "constraint": constraint}}}
    with pytest.raises(ValueError, match=says):
        reached(report, {"sync": 16_000_000})


@pytest.mark.parametrize("net", ["clk", "$glbnet$sync_pll.clk", "clk_$glb_clk"])
def test_a_clock_is_found_by_whatever_name_a_tool_has_for_it(net) -> None:
    report = {"fmax": {net: {"achieved": 42.5, "constraint": 16.0}}}
    assert reached(report, {"sync": 16_000_000}) == {"sync": 42.5}


def test_wrong_inputs_are_told() -> None:
    with pytest.raises(ValueError, match='unit must be one of metro, maglev, not "tram"'):
        build("odometer", "icebreaker", unit="tram")
    with pytest.raises(ValueError, match="seed must be between 0 and 2147483647, not -1"):
        build("odometer", "icebreaker", seed=-1)
    with pytest.raises(ValueError, match="/dev/null/x cannot be written"):
        build("position_link", "icebreaker", folder=Path("/dev/null/x"))
