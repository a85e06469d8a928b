"""The dividers of PLLs: exact clocks, inside the data sheets' limits, or none."""

import re
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import pytest

from railgate.fpga.pll import FAMILIES, setting

MHZ = 1_000_000
BOARDS = [("ecp5", 25), ("ice40", 12), ("himbaechel-gowin", 27)]


def made_hz(family: str, oscillator_hz: int, parameters: dict[str, int], divide: int) -> Fraction:
    """The clock by the formula of each primitive's data sheet."""
    p, reference = parameters, Fraction(oscillator_hz)
    if family == "ecp5":
        feedback = reference / p["CLKI_DIV"] * p["CLKFB_DIV"]
        return feedback * p["CLKOP_DIV"] / p["CLKOS_DIV"] / divide
    if family == "ice40":
        return reference * (p["DIVF"] + 1) / (2 ** p["DIVQ"] * (p["DIVR"] + 1)) / divide
    return reference * (p["FBDIV_SEL"] + 1) / (p["IDIV_SEL"] + 1) / divide


@pytest.mark.shows("SYS-3")
@pytest.mark.parametrize("mhz", [16, 40])
@pytest.mark.parametrize(("family", "oscillator"), BOARDS)
def test_every_board_makes_the_functions_clocks_exactly(family, oscillator, mhz) -> None:
    found = setting(family, oscillator * MHZ, mhz * MHZ)
    assert found.hz == mhz * MHZ
    assert made_hz(family, oscillator * MHZ, found.parameters, found.divide) == mhz * MHZ


@pytest.mark.parametrize(("family", "oscillator"), BOARDS)
def test_what_a_setting_tells_is_what_its_dividers_make(family, oscillator) -> None:
    for each in list(FAMILIES[family](Fraction(oscillator * MHZ)))[::97]:
        assert made_hz(family, oscillator * MHZ, each.parameters, each.divide) == each.hz


LIMITS_MHZ = {
    "ecp5": ((10, 400), (400, 800), (Fraction(25, 8), 400)),
    "ice40": ((10, 133), (533, 1066), (16, 275)),
    "himbaechel-gowin": ((3, 400), (400, 1200), (Fraction(25, 8), 600)),
}
"""Of the phase detector, the oscillator and the output: FPGA-DS-02012, FPGA-DS-02029, DS117."""


@pytest.mark.parametrize(("family", "oscillator"), BOARDS)
def test_all_settings_are_inside_the_limits(family, oscillator) -> None:
    (low, high), oscillates, puts_out = LIMITS_MHZ[family]
    dividers = {"ecp5": ("CLKI_DIV", 0), "ice40": ("DIVR", 1), "himbaechel-gowin": ("IDIV_SEL", 1)}
    name, more = dividers[family]
    for each in FAMILIES[family](Fraction(oscillator * MHZ)):
        assert low <= Fraction(oscillator) / (each.parameters[name] + more) <= high
        assert oscillates[0] <= each.vco_hz / MHZ <= oscillates[1]
        assert puts_out[0] <= each.hz * each.divide / MHZ <= puts_out[1]


def test_a_clock_that_is_not_exact_is_refused_with_the_nearest() -> None:
    says = r"makes exactly of 12 MHz, as 16\.384615\d* MHz|as 16\.\d+ MHz, not 16\.384 MHz"
    with pytest.raises(ValueError, match=says):
        setting("ice40", 12 * MHZ, 16_384_000)


PAIR = re.compile(r"([A-Z]\w+(?: divisor)?)[:(]\s*(\d+)")
"""`DIVR:  0`, `.IDIV_SEL(8)`, `Refclk divisor: 5`."""


def told(tool: str, *arguments: str) -> dict[str, int]:
    """What a vendor-independent tool for PLLs chooses: numbers by their names."""
    command = [str(Path(sys.executable).with_name(tool)), *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return {name: int(value) for name, value in PAIR.findall(done.stdout)}


@pytest.mark.parametrize("mhz", ["17", "40", "60", "100", "133", "240"])
def test_what_icepll_and_gowin_pll_choose_is_among_the_settings(mhz) -> None:
    for family, oscillator, tool, more in (
        ("ice40", "12", "yowasp-icepll", ()),
        ("himbaechel-gowin", "27", "gowin_pll", ("-d", "GW1NR-9 C6/I5")),
    ):
        chosen = told(tool, "-i", oscillator, "-o", mhz, *more)
        settings = FAMILIES[family](Fraction(int(oscillator) * MHZ))
        assert any(
            each.divide == 1 and each.parameters.items() <= chosen.items() for each in settings
        )


@pytest.mark.parametrize("mhz", ["16", "40", "60", "100", "133", "400"])
def test_what_ecppll_reaches_is_among_the_settings(mhz) -> None:
    chosen = told("yowasp-ecppll", "-i", "25", "-o", mhz)
    settings = FAMILIES["ecp5"](Fraction(25 * MHZ))
    reached = Fraction(25 * chosen["Feedback divisor"], chosen["Refclk divisor"])
    assert any(each.hz == reached * MHZ for each in settings)
