"""The evidence of a frame's CRC as a picture: residual error probability and Hamming distance."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from railgate.vital_output.residual.evidence import (
    FEW,
    RATES,
    REQUIRED_BITS,
    Comparison,
    Evidence,
)
from railgate.vital_output.residual.few import distances
from railgate.vital_output.spec.frame import CRC_BITS
from railgate.waves import replacing

__all__ = ["draw"]

COLOURS = ("#2a6fbb", "#c23b3b")
GREY = "#8a8f98"
LOWEST = 1e-70
STYLES: dict[str, dict[str, Any]] = {
    "CRC alone": {"lw": 2},
    "CRC and FCS": {"ls": "--", "lw": 1.5},
    "the same, were bytes sent MSB first": {"ls": ":", "lw": 1, "marker": "o", "mfc": "white"},
    "at most, errors anywhere in the Ethernet frame": {"lw": 0.8, "alpha": 0.7},
}
ALONE, BOTH, REVERSED, BOUND = STYLES
CARRIED = {"Ethernet": BOTH, "Ethernet, bits reversed": REVERSED}
"""The carriages that are drawn."""


def draw(comparison: Comparison, path: Path) -> None:
    """Draw into a PNG file, which is there whole or not. Raises ValueError."""
    figure = Figure(figsize=(12, 6.4), layout="constrained", dpi=110)
    chances, lengths = figure.subplots(1, 2, width_ratios=(1.8, 1))
    codes = [(code, COLOURS[i], 0.03 * i) for i, code in enumerate(comparison.codes)]
    drawn: set[str] = set()
    for code, colour, lower in codes:
        for name, values in _curves(comparison, code).items():
            chances.plot(RATES, values, color=colour, ms=4, markevery=25, **STYLES[name])
            drawn.add(name)
        _draw_lengths(lengths, code, colour, lower)
    polynomials = [Line2D([], [], c=c, lw=2, label=_name(code)) for code, c, _ in codes]
    styles = [Line2D([], [], c=GREY, ms=4, label=n, **STYLES[n]) for n in STYLES if n in drawn]
    chances.legend(handles=[*polynomials, *styles], fontsize=8, frameon=False, loc="lower right")
    _finish_chances(chances)
    _finish_lengths(lengths, comparison.codes[0])
    for ax in (chances, lengths):
        ax.spines[["top", "right"]].set_visible(False)
        ax.grid(alpha=0.25)
    figure.suptitle(_title(comparison.codes[0]), fontsize=11)
    with replacing(path) as new:
        figure.savefig(new, format="png")


def _title(code: Evidence) -> str:
    return (
        f"{code.config.outputs} outputs: a command frame of {code.sent_bits} bits, "
        f"{code.word_bits} with board and time"
    )


def _name(code: Evidence) -> str:
    return f"0x{code.config.polynomial:08X}"


def _curves(comparison: Comparison, code: Evidence) -> dict[str, list[float | None]]:
    """By what it shows; a curve that is not known is missing."""
    carried = {
        CARRIED[each.carriage.name]: [each.probability(rate) for rate in RATES]
        for each in code.carried
        if each.carriage.name in CARRIED and each.spectrum
    }
    return {
        BOUND: [comparison.bound(code, rate) for rate in RATES],
        ALONE: [code.probability(rate) for rate in RATES],
        **carried,
    }


def _finish_chances(ax: Axes) -> None:
    ax.set(xscale="log", yscale="log", xlim=(RATES[0], RATES[-1]), ylim=(LOWEST, 1))
    ax.set_xlabel("bit error rate")
    ax.set_ylabel("probability of an error that is not detected")
    for power in (CRC_BITS, 2 * CRC_BITS):
        ax.axhline(2.0**-power, color=GREY, lw=0.8, zorder=0)
        at = (1.15 * RATES[0], 2.0**-power)
        ax.annotate(
            f"$2^{{-{power}}}$", at, (0, 2), textcoords="offset points", fontsize=9, color=GREY
        )


def _draw_lengths(ax: Axes, code: Evidence, colour: str, lower: float) -> None:
    """Drawn lower by so much, that none hides another."""
    counted = distances(code.few)[CRC_BITS + 1 :]
    data_bits = np.arange(1, counted.size + 1)
    ax.step(data_bits, counted - lower, where="mid", color=colour, lw=2)


def _finish_lengths(ax: Axes, code: Evidence) -> None:
    marks = {
        code.sent_bits - CRC_BITS: "frame",
        code.word_bits - CRC_BITS: "with board and time",
        REQUIRED_BITS: "DRV-4",
    }
    for data_bits, name in marks.items():
        ax.axvline(data_bits, color=GREY, lw=0.8, ls=":", zorder=0)
        ax.text(
            data_bits, 2.1, f"{name}, {data_bits} ", rotation=90, ha="right", fontsize=8, color=GREY
        )
    ax.set_ylim(2, FEW + 1.3)
    ax.set_yticks(range(2, FEW + 2), [*map(str, range(2, FEW + 1)), rf"$\geq {FEW + 1}$"])
    ax.set_xlim(left=0)
    ax.set_xlabel("data bits")
    ax.set_ylabel("Hamming distance")
