"""The states of one output in both FPGAs as a diagram, with the path that a run took."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch

from railgate.vital_output.observed import Observed
from railgate.vital_output.picture import COLORS, FPGAS, GREY, INK, SECOND, shown
from railgate.vital_output.simulate import Run
from railgate.vital_output.spec import State
from railgate.vital_output.timeline import NAMES, seconds
from railgate.waves import replacing

__all__ = ["EDGES", "draw_states"]

PLACES = {
    State.IDLE: (0.0, 2.8),
    State.PRE_DRIVE: (4.2, 5.4),
    State.DRIVE: (10.0, 3.7),
    State.WAIT: (5.2, 2.4),
    State.TEST: (3.4, 0.2),
    State.HANDSHAKE_ALARM: (8.2, 7.4),
    State.FEEDBACK_ALARM: (8.6, -1.6),
}
SIZE = (2.2, 0.8)
TAKEN = (
    ("#b9bec6", "not taken"),
    (FPGAS[0], "by FPGA 1 alone"),
    (FPGAS[1], "by FPGA 2 alone"),
    (INK, "by both"),
)
"""Colour and meaning of an arrow: of 1 for FPGA 1 and 2 for FPGA 2 together."""


@dataclass(frozen=True)
class Edge:
    """why: what leads from state to state. bend: of the arrow. place: where along it this stands,
    from 0 to 1."""

    why: str
    bend: float = 0.0
    place: float = 0.5


EDGES: Mapping[tuple[State, State], Edge] = {
    (State.IDLE, State.PRE_DRIVE): Edge("command 1", -0.15),
    (State.IDLE, State.WAIT): Edge("feedback", -0.16, 0.55),
    (State.IDLE, State.TEST): Edge("test begins"),
    (State.IDLE, State.FEEDBACK_ALARM): Edge("feedback in the peer's test", 0.42),
    (State.PRE_DRIVE, State.IDLE): Edge("command 0", -0.12),
    (State.PRE_DRIVE, State.DRIVE): Edge("peer ready", -0.1, 0.55),
    (State.PRE_DRIVE, State.WAIT): Edge("feedback", 0.0, 0.57),
    (State.PRE_DRIVE, State.HANDSHAKE_ALARM): Edge("τ1 over"),
    (State.DRIVE, State.WAIT): Edge("command 0 or peer off", 0.0, 0.45),
    (State.DRIVE, State.HANDSHAKE_ALARM): Edge("peer in alarm or not driving", 0.1),
    (State.DRIVE, State.FEEDBACK_ALARM): Edge("feedback wrong", -0.1),
    (State.WAIT, State.IDLE): Edge("no feedback", -0.16, 0.45),
    (State.WAIT, State.HANDSHAKE_ALARM): Edge("peer off, command stays 1", 0.12, 0.35),
    (State.WAIT, State.FEEDBACK_ALARM): Edge("feedback stays"),
    (State.TEST, State.WAIT): Edge("passed"),
    (State.TEST, State.FEEDBACK_ALARM): Edge("contact, or no pulses"),
    (State.HANDSHAKE_ALARM, State.IDLE): Edge("command 0, no feedback", 0.36),
    (State.FEEDBACK_ALARM, State.IDLE): Edge("acknowledged, command 0, no feedback", -0.7),
}
"""All that DRV-8 … DRV-12 and DRV-18 allow."""
OTHER = Edge("not allowed", 0.2)


def draw_states(run: Run, path: Path) -> None:
    """Draw into a PNG file, which is there whole or not. Raises ValueError."""
    output = shown(run)[0]
    taken = [_taken(channel, output) for channel in run.channels]
    figure = Figure(figsize=(11, 9.2), layout="constrained", dpi=110)
    ax = figure.subplots()
    ends = [State(int(channel.state(output).values[-1])) for channel in run.channels]
    nodes = {state: _node(ax, state, ends) for state in State}
    for edge in dict.fromkeys([*EDGES, *taken[0], *taken[1]]):
        _edge(ax, nodes, edge, [each.get(edge, []) for each in taken])
    ax.set_xlim(-1.3, 11.3)
    ax.set_ylim(-3.0, 8.0)
    ax.set_aspect("equal")
    ax.axis("off")
    _legend(ax)
    figure.suptitle(
        f"output {output}: how often, and when first, each FPGA went from state to state"
        f"{_resets(run)}",
        fontsize=11,
    )
    with replacing(path) as new:
        figure.savefig(new, format="png")


def _resets(run: Run) -> str:
    """What else leads to idle."""
    told = [
        f"FPGA {channel.fpga} {channel.resets.size} ×, {seconds(channel.resets[0] / SECOND)} s"
        for channel in run.channels
        if channel.resets.size
    ]
    return f"\nreset to idle: {'; '.join(told)}" if told else ""


def _legend(ax: Axes) -> None:
    """What the arrows' colours mean."""
    lines = [Line2D([], [], color=color, label=name) for color, name in TAKEN]
    ax.legend(handles=lines, loc="upper left", fontsize=8, frameon=False)


def _taken(channel: Observed, output: int) -> dict[tuple[State, State], list[int]]:
    """When each edge was taken, femtoseconds."""
    found: dict[tuple[State, State], list[int]] = {}
    for at, old, new in channel.transitions(output):
        found.setdefault((State(old), State(new)), []).append(at)
    return found


def _node(ax: Axes, state: State, ends: Sequence[State]) -> FancyBboxPatch:
    """A box, with what stays in it at the run's end."""
    (x, y), (width, height) = PLACES[state], SIZE
    node = FancyBboxPatch(
        (x - width / 2, y - height / 2),
        width,
        height,
        boxstyle="round,pad=0,rounding_size=0.2",
        fc=COLORS[state],
        ec=INK,
        lw=2.5 if state in ends else 0.8,
        zorder=3,
    )
    ax.add_patch(node)
    here = [f"FPGA {fpga}" for fpga, end in enumerate(ends, 1) if end is state]
    told = f"{NAMES[state]}\nat the end: {', '.join(here)}" if here else NAMES[state]
    ax.text(x, y, told, ha="center", va="center", fontsize=8, zorder=4)
    return node


def _edge(
    ax: Axes,
    nodes: Mapping[State, FancyBboxPatch],
    edge: tuple[State, State],
    times: Sequence[Sequence[int]],
) -> None:
    """An arrow, bold where it was taken, with what leads along it and what each FPGA made of it."""
    first, second = (bool(each) for each in times)
    color, _ = TAKEN[first + 2 * second]
    drawn = EDGES.get(edge, OTHER)
    bold = first or second
    arrow = FancyArrowPatch(
        *(PLACES[state] for state in edge),
        connectionstyle=f"arc3,rad={drawn.bend}",
        arrowstyle="-|>",
        mutation_scale=14 if bold else 9,
        patchA=nodes[edge[0]],
        patchB=nodes[edge[1]],
        color=color,
        lw=2.2 if bold else 0.9,
        zorder=2 if bold else 1,
    )
    ax.add_patch(arrow)
    told = [
        f"FPGA {fpga}: {len(each)} ×, {seconds(each[0] / SECOND)} s"
        for fpga, each in enumerate(times, 1)
        if each
    ]
    _label(ax, edge, drawn, "\n".join([drawn.why, *told]), bold)


def _label(ax: Axes, edge: tuple[State, State], drawn: Edge, text: str, bold: bool) -> None:
    """On the arrow, which is a Bézier curve of second order, as matplotlib bends it."""
    (x0, y0), (x2, y2) = (PLACES[state] for state in edge)
    x1, y1 = (x0 + x2) / 2 + drawn.bend * (y2 - y0), (y0 + y2) / 2 - drawn.bend * (x2 - x0)
    part, rest = drawn.place, 1 - drawn.place
    ax.text(
        rest**2 * x0 + 2 * part * rest * x1 + part**2 * x2,
        rest**2 * y0 + 2 * part * rest * y1 + part**2 * y2,
        text,
        ha="center",
        va="center",
        fontsize=7,
        color=INK if bold else GREY,
        bbox={"fc": "white", "ec": "none", "pad": 1},
        zorder=5 if bold else 2.5,
    )
