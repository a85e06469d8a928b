"""A timing diagram: signals over a common time, as SVG in the page's colours."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from html import escape
from io import StringIO

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from railgate.waves import Waveform

__all__ = ["Diagram", "Lane", "draw"]

Values = Callable[[int], str]
"""What a value is called in its lane."""

INK, SOFT, BUS, MARK = "#010101", "#020202", "#030303", "#040404"
"""Stand for the page's own colours, which an SVG inside it can have."""
COLOURS = {
    INK: "currentColor",
    SOFT: "var(--color-foreground-border)",
    BUS: "var(--timing-bus)",
    MARK: "var(--timing-mark)",
}
LANE_INCHES, WIDTH_INCHES, BELOW_INCHES = 0.3, 9.0, 0.44
LEFT, RIGHT = 0.16, 0.02
"""Of the width, beside the axes."""
EDGE = 0.62
"""Of a lane, the height of a signal in it."""
CHARACTER = 0.0085
"""Of the width of the axes: what a character takes."""
DENSE = 2000
"""Of more edges than that only where they are is shown."""


@dataclass(frozen=True)
class Lane:
    """One signal. values: how its values are called; None: it is one bit, drawn as a level."""

    name: str
    wave: Waveform
    values: Values | None = None


@dataclass(frozen=True)
class Diagram:
    """title: what is seen, for those who do not see it. tick_s: of the lanes' waveforms, seconds.
    start, end: ticks. unit: ns, µs, ms, s or ticks, counted from `zero`. marks: ticks and texts."""

    title: str
    lanes: Sequence[Lane]
    tick_s: float
    start: float
    end: float
    unit: str = "ms"
    zero: float = 0.0
    marks: Sequence[tuple[float, str]] = ()

    @property
    def scale(self) -> float:
        """Units in a tick."""
        return {"ticks": 1.0}.get(self.unit) or self.tick_s * PER_SECOND[self.unit]


PER_SECOND = {"ns": 1e9, "µs": 1e6, "ms": 1e3, "s": 1.0}


def draw(diagram: Diagram, name: str) -> str:
    """The SVG; `name` makes its inner names unlike those of others in the page."""
    with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": name}):
        rows = len(diagram.lanes) + bool(diagram.marks)
        figure = Figure((WIDTH_INCHES, LANE_INCHES * rows + BELOW_INCHES))
        below = BELOW_INCHES / figure.get_figheight()
        axes = figure.add_axes((LEFT, below, 1 - LEFT - RIGHT, 1 - below))
        _frame(axes, diagram, rows)
        for row, lane in enumerate(diagram.lanes):
            _lane(axes, diagram, lane, -row - 1.0)
        for at, text in diagram.marks:
            x = (at - diagram.zero) * diagram.scale
            axes.axvline(x, color=MARK, linewidth=0.9, linestyle=(0, (4, 3)), zorder=1)
            left = x < sum(axes.get_xlim()) / 2
            side, told = ("left", f" {text}") if left else ("right", f"{text} ")
            axes.text(x, 0.25, told, color=MARK, fontsize=8, va="bottom", ha=side)
        written = StringIO()
        plain = {"Date": None, "Creator": None}
        figure.savefig(written, format="svg", transparent=True, metadata=plain)
    return _themed(written.getvalue(), diagram.title)


def _frame(axes: Axes, diagram: Diagram, rows: int) -> None:
    axes.set_xlim(*((t - diagram.zero) * diagram.scale for t in (diagram.start, diagram.end)))
    axes.set_ylim(-len(diagram.lanes) - 0.4, rows - len(diagram.lanes) + 0.1)
    axes.set_yticks([-row - 1 + EDGE / 2 for row in range(len(diagram.lanes))])
    axes.set_yticklabels([lane.name for lane in diagram.lanes], color=INK, fontsize=9)
    axes.tick_params(axis="y", length=0)
    axes.tick_params(axis="x", colors=INK, labelsize=8, color=SOFT)
    axes.grid(axis="x", color=SOFT, linewidth=0.4, alpha=0.5)
    axes.set_xlabel(diagram.unit, color=INK, fontsize=8, loc="right", labelpad=0)
    for side, spine in axes.spines.items():
        spine.set_visible(side == "bottom")
        spine.set_color(SOFT)


def _lane(axes: Axes, diagram: Diagram, lane: Lane, low: float) -> None:
    first = np.searchsorted(lane.wave.ticks, diagram.start, side="right") - 1
    last = np.searchsorted(lane.wave.ticks, diagram.end, side="left")
    ticks = lane.wave.ticks[max(first, 0) : last].astype(float)
    values = lane.wave.values[max(first, 0) : last]
    ticks[0] = max(ticks[0], diagram.start)
    x = (np.append(ticks, diagram.end) - diagram.zero) * diagram.scale
    if lane.values is None:
        _level(axes, x, values, low)
    else:
        _bus(axes, x, [lane.values(int(value)) for value in values], low)


def _level(axes: Axes, x: NDArray[np.float64], values: NDArray[np.int64], low: float) -> None:
    if values.size > DENSE:
        axes.fill_between(x[[0, -1]], low, low + EDGE, color=BUS, alpha=0.5, linewidth=0)
        return
    y = low + EDGE * np.append(values, values[-1]).astype(float)
    axes.plot(x, y, drawstyle="steps-post", color=INK, linewidth=1.1)


def _bus(axes: Axes, x: NDArray[np.float64], names: Sequence[str], low: float) -> None:
    whole = float(np.subtract(*axes.get_xlim())) * -1
    lean = whole * 0.002
    for begin, end, name in zip(x[:-1].tolist(), x[1:].tolist(), names, strict=True):
        inset = min(lean, (end - begin) / 2)
        middle = low + EDGE / 2
        across = [begin, begin + inset, end - inset, end, end - inset, begin + inset]
        down = [middle, low + EDGE, low + EDGE, middle, low, low]
        axes.fill(across, down, facecolor=BUS, edgecolor=INK, linewidth=0.7, alpha=0.85)
        if name and end - begin > whole * CHARACTER * (len(name) + 1):
            axes.text(
                (begin + end) / 2,
                middle - 0.02,
                name,
                color=INK,
                fontsize=7.5,
                ha="center",
                va="center",
                clip_on=True,
            )


def _themed(svg: str, title: str) -> str:
    """The figure alone, in the page's colours and font, with its title for those who listen."""
    svg = svg[svg.index("<svg") :]
    for stand_in, colour in COLOURS.items():
        svg = svg.replace(stand_in, colour)
    svg = re.sub(r' id="(?!m|p|h|C|Deja)[a-z0-9]+_\d+"', "", svg)
    svg = re.sub(r"font: ([\d.]+px) [^;\"]*", r"font-size: \1", svg)
    opened = f'<svg role="img" aria-label="{escape(title)}"'
    return svg.replace("<svg", opened, 1) + f"<figcaption>{escape(title)}</figcaption>"
