"""The dividers of a part's PLL, for a clock that is wanted of an oscillator.

A function's ticks have the length that its configuration tells, so a clock is exact or none: what a
PLL only comes near to is refused. The limits are those of the data sheets: FPGA-DS-02012 (ECP5),
FPGA-DS-02029 and -02008 (iCE40), DS117 (GW1NR).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction

__all__ = ["FAMILIES", "Setting", "setting"]

MHZ = 1_000_000


@dataclass(frozen=True)
class Setting:
    """Of a PLL: its dividers, and `divide`, by which the clock is divided behind its output.

    Parameters have the names that the part's primitive has for them.
    """

    hz: Fraction
    vco_hz: Fraction
    divide: int
    parameters: Mapping[str, int]


def setting(family: str, oscillator_hz: int, wanted_hz: int) -> Setting:
    """The one that gives the clock exactly, with as little behind the PLL and as near to the middle
    of the oscillator's range as can be. Raises ValueError where there is none."""
    found = list(FAMILIES[family](Fraction(oscillator_hz)))
    exact = [each for each in found if each.hz == wanted_hz]
    if not exact:
        nearest = min((each.hz for each in found), key=lambda hz: abs(hz - wanted_hz))
        raise ValueError(
            f"a clock must be one that the PLL makes exactly of {oscillator_hz / MHZ:g} MHz, "
            f"as {float(nearest) / MHZ:.9g} MHz, not {wanted_hz / MHZ:.9g} MHz"
        )
    low, high = (pick(each.vco_hz for each in found) for pick in (min, max))
    middle = (low + high) / 2
    return min(exact, key=lambda each: (each.divide, abs(each.vco_hz - middle)))


def _ecp5(oscillator: Fraction) -> Iterator[Setting]:
    """CLKOP is the feedback alone, of the phase detector's frequency; CLKOS is the clock."""
    for divider in range(1, 129):
        detector = oscillator / divider
        if not 10 * MHZ <= detector <= 400 * MHZ:
            continue
        for times in range(1, 129):
            vco = detector * times
            if not 400 * MHZ <= vco <= 800 * MHZ:
                continue
            for output in range(1, 129):
                if Fraction(3_125_000) <= vco / output <= 400 * MHZ:
                    told = {"CLKI_DIV": divider, "CLKOP_DIV": times, "CLKOS_DIV": output}
                    yield Setting(vco / output, vco, 1, {**told, "CLKFB_DIV": 1})


def _ice40(oscillator: Fraction) -> Iterator[Setting]:
    for divider in range(16):
        detector = oscillator / (divider + 1)
        if not 10 * MHZ <= detector <= 133 * MHZ:
            continue
        edges = (17, 26, 44, 66, 101)
        filter_range = 1 + sum(detector >= edge * MHZ for edge in edges)
        for times in range(128):
            vco = detector * (times + 1)
            if not 533 * MHZ <= vco <= 1066 * MHZ:
                continue
            for output in range(1, 7):
                told = {"DIVR": divider, "DIVF": times, "DIVQ": output}
                hz = vco / 2**output
                if 16 * MHZ <= hz <= 275 * MHZ:
                    for divide in range(1, 9):
                        parameters = {**told, "FILTER_RANGE": filter_range}
                        yield Setting(hz / divide, vco, divide, parameters)


def _gowin(oscillator: Fraction) -> Iterator[Setting]:
    """What is divided has outputs of the PLL: CLKOUTD3 a third, CLKOUTD an even part."""
    for divider in range(64):
        detector = oscillator / (divider + 1)
        if not 3 * MHZ <= detector <= 400 * MHZ:
            continue
        for times in range(64):
            hz = detector * (times + 1)
            if not Fraction(3_125_000) <= hz <= 600 * MHZ:
                continue
            for output in (2, 4, 8, *range(16, 129, 16)):
                if 400 * MHZ <= hz * output <= 1200 * MHZ:
                    told = {"IDIV_SEL": divider, "FBDIV_SEL": times, "ODIV_SEL": output}
                    for divide in (1, 2, 3, 4, 6, 8):
                        yield Setting(hz / divide, hz * output, divide, told)


FAMILIES: Mapping[str, Callable[[Fraction], Iterator[Setting]]] = {
    "ecp5": _ecp5,
    "ice40": _ice40,
    "himbaechel-gowin": _gowin,
}
"""All settings of a family's PLL for an oscillator, by nextpnr's name of the architecture."""
