"""The states of one output in both FPGAs as a diagram, with the path that a run took."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch

from railgate.vital_output.observed import Observed
from railgate.vital_output.picture import COLORS, FPGAS, INK, SECOND, shown
from railgate.vital_output.simulate import Run
from railgate.vital_output.spec import State
from railgate.vital_output.timeline import NAMES
from railgate.vital_output.table import seconds
from railgate.waves import replacing

__all__ = ["EDGES", "draw_states"]

PLACES = {
    State.IDLE: (0.0, 3.0),
    State.PRE_DRIVE: (4.0, 5.2),
    State.DRIVE: (9.0, 3.6),
    State.WAIT: (4.6, 2.6),
    State.TEST: (2.0, 0.4),
    State.HANDSHAKE_ALARM: (7.0, 7.2),
    State.FEEDBACK_ALARM: (7.0, -0.8),
}
PALE = "#b9bec6"
SIZE = (1.9, 0.7)
EDGES: Mapping[tuple[State, State], tuple[float, float]] = {
    (State.IDLE, State.PRE_DRIVE): (-0.12, 0.5),
    (State.IDLE, State.WAIT): (-0.1, 0.5),
    (State.IDLE, State.TEST): (0.1, 0.5),
    (State.IDLE, State.FEEDBACK_ALARM): (0.35, 0.5),
    (State.PRE_DRIVE, State.IDLE): (-0.12, 0.5),
    (State.PRE_DRIVE, State.DRIVE): (-0.1, 0.5),
    (State.PRE_DRIVE, State.WAIT): (0.0, 0.5),
    (State.PRE_DRIVE, State.HANDSHAKE_ALARM): (0.0, 0.5),
    (State.DRIVE, State.WAIT): (0.0, 0.5),
    (State.DRIVE, State.HANDSHAKE_ALARM): (0.1, 0.5),
    (State.DRIVE, State.FEEDBACK_ALARM): (-0.1, 0.5),
    (State.WAIT, State.IDLE): (-0.1, 0.5),
    (State.WAIT, State.HANDSHAKE_ALARM): (0.1, 0.5),
    (State.WAIT, State.FEEDBACK_ALARM): (0.0, 0.5),
    (State.TEST, State.WAIT): (0.0, 0.5),
    (State.TEST, State.FEEDBACK_ALARM): (0.0, 0.5),
    (State.HANDSHAKE_ALARM, State.IDLE): (0.3, 0.5),
    (State.FEEDBACK_ALARM, State.IDLE): (-0.55, 0.5),
}
"""All that DRV-8 … DRV-12 and DRV-18 allow: how much each is bent, and where along it its label
is."""


def draw_states(run: Run, path: Path) -> None:
    """Draw into a PNG file, which is there whole or not. Raises ValueError."""
    output = shown(run)[0]
    taken = [_taken(channel, output) for channel in run.channels]
    figure = Figure(figsize=(11, 8.5), layout="constrained", dpi=110)
    ax = figure.subplots()
    ends = [State(int(channel.state(output).values[-1])) for channel in run.channels]
    nodes = {state: _node(ax, state, ends) for state in State}
    for edge in dict.fromkeys([*EDGES, *taken[0], *taken[1]]):
        _edge(ax, nodes, edge, [each.get(edge, []) for each in taken])
    ax.set_xlim(-1.6, 10.6)
    ax.set_ylim(-2.6, 8.0)
    ax.set_aspect("equal")
    ax.axis("off")
    figure.suptitle(
        f"output {output}: how often, and when first, each FPGA went from state to state",
        fontsize=11,
    )
    with replacing(path) as new:
        figure.savefig(new, format="png")


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
    """An arrow, bold where it was taken, with what each FPGA has to say of it."""
    bend, place = EDGES.get(edge, (0.2, 0.5))
    took = [bool(each) for each in times]
    color = {(False, False): PALE, (True, False): FPGAS[0], (False, True): FPGAS[1]}
    (x0, y0), (x2, y2) = (PLACES[state] for state in edge)
    ax.add_patch(
        FancyArrowPatch(
            (x0, y0),
            (x2, y2),
            connectionstyle=f"arc3,rad={bend}",
            arrowstyle="-|>",
            mutation_scale=14 if any(took) else 9,
            patchA=nodes[edge[0]],
            patchB=nodes[edge[1]],
            shrinkA=2,
            shrinkB=2,
            color=color.get((took[0], took[1]), INK),
            lw=2.2 if any(took) else 0.9,
            zorder=2 if any(took) else 1,
        )
    )
    x1, y1 = (x0 + x2) / 2 + bend * (y2 - y0), (y0 + y2) / 2 - bend * (x2 - x0)
    ax.text(
        _bezier(place, x0, x1, x2),
        _bezier(place, y0, y1, y2),
        "\n".join(
            f"FPGA {fpga}: {len(each)} ×, {seconds(each[0] / SECOND)} s"
            for fpga, each in enumerate(times, 1)
            if each
        ),
        ha="center",
        va="center",
        fontsize=7,
        bbox={"fc": "white", "ec": "none", "pad": 1.5} if any(took) else None,
        zorder=5,
    )


def _bezier(part: float, start: float, middle: float, end: float) -> float:
    return (1 - part) ** 2 * start + 2 * part * (1 - part) * middle + part**2 * end
