"""The evidence of a frame's CRC as a person reads it in a terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from math import comb

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from railgate.vital_output.residual.evidence import (
    FEW,
    RATES,
    REQUIRED_BITS,
    REQUIRED_RATE,
    Carried,
    Comparison,
    Evidence,
)
from railgate.vital_output.residual.spectrum import MOST_GENERATORS
from railgate.vital_output.spec.frame import CRC_BITS

__all__ = ["show"]

Row = tuple[str, Callable[[Evidence], str], str]
"""What it is, how it reads for a polynomial, how it is known."""

TITLES = {
    "Ethernet": "with Ethernet's FCS",
    "Ethernet, bits reversed": "the same, were bytes sent MSB first",
    "cross-link": "forwarded, with the cross-link's CRC",
}
COUNTED = "exact, all errors"
FEW_COUNTED = f"exact, all of ≤ {FEW} bits"
RANK = "exact, rank everywhere"
AT_RATES = f"exact, at {len(RATES)} rates"
LEGEND = (
    "Probabilities are of a binary symmetric channel. Not counted: both the code and its dual have "
    f"more than 2^{MOST_GENERATORS} words."
)


def show(comparison: Comparison) -> RenderableType:
    """The polynomials side by side: the frame alone, and on each line."""
    code = comparison.codes[0]
    table = Table(box=SIMPLE_HEAD, pad_edge=False, caption_justify="left")
    table.add_column(f"{code.config.outputs} outputs: {code.sent_bits} bits sent")
    for each in comparison.codes:
        table.add_column(f"{each.config.polynomial:#010x}", justify="right", no_wrap=True)
    table.add_column("how it is known", style="dim")
    _fill(table, comparison, "CRC alone", _alone(code))
    for line, carried in enumerate(code.carried):
        _fill(table, comparison, TITLES[carried.carriage.name], _on(line))
    at = f"probability at {REQUIRED_RATE:g}"
    row: Row = (at, lambda each: f"≤ {comparison.bound(each, REQUIRED_RATE):.2e}", "bound")
    _fill(table, comparison, "on Ethernet, errors anywhere in its frame", [row])
    return Group(table, Text(LEGEND, "dim"))


def _fill(table: Table, comparison: Comparison, title: str, rows: Iterable[Row]) -> None:
    table.add_row(Text(title, "bold"))
    for name, value, how in rows:
        table.add_row(f"  {name}", *map(value, comparison.codes), how)
    table.add_section()


def _alone(code: Evidence) -> list[Row]:
    sent, word = code.sent_bits, code.word_bits
    data = word - CRC_BITS
    rate = f"{REQUIRED_RATE:g}"
    return [
        ("errors of 1, 2, 3 bits that pass", lambda e: _three(e, sent), COUNTED),
        (f"of {word} bits, with board and time", lambda e: _three(e, word), COUNTED),
        ("Hamming distance", lambda e: str(e.distance), COUNTED),
        ("errors of so many bits that pass", _at_distance, COUNTED),
        (f"distance of {data} data bits, board and time", _distance_at(data), FEW_COUNTED),
        (f"distance of {REQUIRED_BITS} data bits", _distance_at(REQUIRED_BITS), FEW_COUNTED),
        (f"data bits up to which it is {FEW + 1} or more", lambda e: e.reach, FEW_COUNTED),
        ("bits up to which all bursts are detected", lambda e: str(e.burst), RANK),
        *(_chance(rate) for rate in (1e-6, 1e-4, REQUIRED_RATE)),
        ("greatest probability / 2⁻³²", _greatest, AT_RATES),
        (f"passing in an hour at {rate}", lambda e: f"{e.per_hour(REQUIRED_RATE):.2e}", "exact"),
    ]


def _distance_at(data_bits: int) -> Callable[[Evidence], str]:
    return lambda code: code.distance_at(data_bits)


def _greatest(code: Evidence) -> str:
    probability, rate = code.greatest
    return f"{probability * 2**CRC_BITS:.3f} at {rate:.2g}"


def _chance(rate: float) -> Row:
    return f"probability at {rate:g}", lambda e: f"{e.probability(rate):.2e}", "exact"


def _three(code: Evidence, length: int) -> str:
    return ", ".join(str(passing) for passing in code.few[1:4, length])


def _at_distance(code: Evidence) -> str:
    return f"{code.sent[code.distance]} of {comb(code.sent_bits, code.distance):.2e}"


def _on(line: int) -> list[Row]:
    def of(value: Callable[[Carried], str]) -> Callable[[Evidence], str]:
        return lambda code: value(code.carried[line])

    chance = of(lambda c: _or(c.probability(REQUIRED_RATE), ".2e"))
    greatest = of(lambda c: _or(c.greatest and c.greatest * 2.0 ** (2 * CRC_BITS), ".4g"))
    return [
        ("rank of both checks", of(lambda c: str(c.rank)), "exact"),
        ("line's generator as an error: passes both", of(_generators), "exact, every place"),
        ("bits up to which the CRC detects all bursts", of(lambda c: str(c.bursts[0])), RANK),
        ("bits up to which both together do", of(lambda c: str(c.bursts[1])), RANK),
        ("Hamming distance of both", of(lambda c: _or(c.distance, "d")), COUNTED),
        (f"probability at {REQUIRED_RATE:g}, errors in the frame", chance, "exact"),
        ("greatest probability / 2⁻⁶⁴", greatest, AT_RATES),
    ]


def _generators(carried: Carried) -> str:
    passing, places = carried.generators
    return f"{passing} of {places}"


def _or(value: float | None, form: str) -> str:
    return "not counted" if value is None else format(value, form)
