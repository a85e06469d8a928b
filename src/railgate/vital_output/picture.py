"""A run of the vital output as a picture: commands, states, life, contacts, causes over time."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from railgate.vital_output.observed import Observed
from railgate.vital_output.plant.edges import femtoseconds
from railgate.vital_output.plant.faults import FAULTS
from railgate.vital_output.simulate import Run
from railgate.vital_output.spec import CAUSES, Cause, State
from railgate.vital_output.timeline import NAMES
from railgate.vital_output.verdict import Closing
from railgate.waves import Waveform, replacing

__all__ = ["COLORS", "FPGAS", "GREY", "INK", "SECOND", "draw", "shown"]

RED, GREY, VIOLET, INK = "#c23b3b", "#8a8f98", "#a13d97", "#2b2f36"
FPGAS = ("#2a6fbb", "#d9822b")
"""FPGA 1 and FPGA 2."""
COLORS = {
    State.IDLE: "#dfe3e8",
    State.PRE_DRIVE: "#e0b13c",
    State.DRIVE: "#4f9d69",
    State.WAIT: "#5aa6c9",
    State.TEST: "#9b86c9",
    State.HANDSHAKE_ALARM: "#e2794a",
    State.FEEDBACK_ALARM: RED,
}
GOOD = ("accepted", "start")
"""Counters of frames that are right."""
FEW_FRAMES = 400
"""Of more only those rejected have a mark."""
MOST_OUTPUTS = 3
SECOND = 1e15
"""Femtoseconds."""


def shown(run: Run) -> list[int]:
    """The outputs that are drawn, at most three: those with an alarm or a contact that closed
    first, then those that were commanded; at least output 0."""
    moved = {each.output for each in run.verdict.closings}
    alarms = (State.HANDSHAKE_ALARM, State.FEEDBACK_ALARM)
    for output in range(run.config.outputs):
        if any(np.isin(c.state(output).values, alarms).any() for c in run.channels):
            moved.add(output)
    wanted = 0
    for command in run.scenario.commands:
        wanted |= command.image
    commanded = {output for output in range(run.config.outputs) if wanted >> output & 1}
    first = [*sorted(moved), *sorted(commanded - moved)][:MOST_OUTPUTS]
    return sorted(first) or [0]


def draw(run: Run, path: Path) -> None:
    """Draw into a PNG file, which is there whole or not. Raises ValueError."""
    outputs = shown(run)
    causes = [c for c in CAUSES if any(each.total(c.name.lower()) for each in run.channels)]
    rows = [len(run.scenario.faults), *[6] * len(outputs), 3, len(causes)]
    heights = [0.3 + 0.22 * rows_in for rows_in in rows if rows_in]
    figure = Figure(figsize=(11, 1.2 + 1.35 * sum(heights)), layout="constrained", dpi=110)
    axes = list(np.atleast_1d(figure.subplots(len(heights), 1, sharex=True, height_ratios=heights)))
    left = iter(axes)
    if run.scenario.faults:
        _faults(next(left), run)
    for output in outputs:
        _output(next(left), run, output)
    _life(next(left), run)
    if causes:
        _causes(next(left), run, causes)
    axes[-1].set_xlabel("time / s")
    for ax in axes:
        ax.spines[["top", "right"]].set_visible(False)
        ax.set_xlim(0, float(run.scenario.seconds))
        ax.grid(alpha=0.25, axis="x")
    _legend(axes[0], run, outputs)
    figure.align_ylabels(axes)
    figure.suptitle(_title(run), fontsize=11)
    with replacing(path) as new:
        figure.savefig(new, format="png")


def _title(run: Run) -> str:
    verdict = run.verdict
    worst = verdict.worst_s("failure")
    seen = "" if worst is None else f", opened by a failure after {float(worst) * 1e3:.1f} ms"
    judged = "a contact was closed too long" if verdict.violations else "no contact closed too long"
    return (
        f"{judged}{seen}, declared {float(verdict.declared_s) * 1e3:.1f} ms  ·  {run.engine}, "
        f"{run.config.clock_hz / 1e6:g} MHz"
    )


def _legend(ax: Axes, run: Run, outputs: Sequence[int]) -> None:
    """The states that occur, above everything."""
    waves = [channel.state(output) for channel in run.channels for output in outputs]
    seen = sorted({int(code) for wave in waves for code in wave.values})
    patches = [Patch(color=COLORS[State(code)], label=NAMES[State(code)]) for code in seen]
    patches += [Patch(color=color, label=f"FPGA {fpga}") for fpga, color in enumerate(FPGAS, 1)]
    ax.legend(
        handles=[*patches, Patch(color=RED, alpha=0.5, label="declared reaction")],
        loc="lower left",
        bbox_to_anchor=(0, 1),
        ncols=len(patches) + 1,
        fontsize=8,
        frameon=False,
        handlelength=1.4,
        columnspacing=1.4,
    )


def _faults(ax: Axes, run: Run) -> None:
    """A bar each, from its beginning to its end, or a mark where it has none."""
    end = float(run.scenario.seconds)
    names = []
    for row, fault in enumerate(run.scenario.faults):
        start = float(fault.start_s)
        lasts = FAULTS[fault.kind].lasting
        stop = end if fault.end_s is None else min(float(fault.end_s), end)
        if fault.end_s is not None or lasts:
            ax.barh(row, stop - start, left=start, height=0.4, color=VIOLET, alpha=0.6, lw=0)
        ax.plot(start, row, "|", color=VIOLET, ms=11, mew=2)
        names.append(fault.kind if fault.value is None else f"{fault.kind}:{fault.value}")
    _rows(ax, names)
    ax.set_ylabel("faults")


def _rows(ax: Axes, names: Sequence[str]) -> None:
    """A row each, the first one on top."""
    ax.set_yticks(range(len(names)), names, fontsize=8)
    ax.set_ylim(len(names) - 0.5, -0.5)


def _output(ax: Axes, run: Run, output: int) -> None:
    """Commands as they came, states, the contact, and how long it may stay closed."""
    end = run.trace.end
    for row, channel in enumerate(run.channels):
        _frames(ax, row, channel, output)
        wave = channel.state(output)
        for state in State:
            _bars(ax, 2 + row, _spans(wave, state, end), COLORS[state])
    contact = run.trace["contact"]
    closed = Waveform.of(contact.ticks, contact.values >> output & 1)
    _bars(ax, 4, _spans(closed, 1, end), INK)
    for each in run.verdict.closings:
        told = each.opened_by == "failure" or run.verdict.too_long(each)
        if each.output == output and told:
            _declared(ax, run, each)
    _rows(ax, ["CPU 1", "CPU 2", "FPGA 1", "FPGA 2", "contact", "declared"])
    ax.set_ylabel(f"output {output}")


def _frames(ax: Axes, row: int, channel: Observed, output: int) -> None:
    """A mark for each frame that came, a cross for one rejected; a bar from one that commands the
    output on, for a cycle at most."""
    frames, color = channel.frames, FPGAS[channel.fpga - 1]
    cycle = femtoseconds(channel.config.cycle_s)
    nexts = [*(frame.at for frame in frames[1:]), channel.trace.end]
    on = [
        (frame.at, min(stop, frame.at + cycle))
        for frame, stop in zip(frames, nexts, strict=True)
        if frame.image >> output & 1
    ]
    _bars(ax, row, on, color, alpha=0.35)
    good = {channel.judged(at).tick for name in GOOD for at, _ in channel.counted(name)}
    few = "|" if len(frames) < FEW_FRAMES else ""
    for mark, drawn, accepted in ((few, color, True), ("x", RED, False)):
        at = [frame.at / SECOND for frame in frames if (frame.tick in good) is accepted]
        ax.plot(at, [row] * len(at), ls="", marker=mark, color=drawn, ms=5, mew=1.2)


def _declared(ax: Axes, run: Run, each: Closing) -> None:
    """From the last live 1, or the closing where there was none, as long as is declared."""
    begin = each.closed if each.live is None else max(each.closed, each.live)
    start, width = begin / SECOND, float(run.verdict.declared_s)
    ax.barh(5, width, left=start, height=0.3, color=RED, alpha=0.5, lw=0)


def _spans(wave: Waveform, value: int, end: int) -> list[tuple[int, int]]:
    """Where the signal has this value."""
    stops = np.append(wave.ticks[1:], end)
    there = wave.values == value
    return list(zip(wave.ticks[there].tolist(), stops[there].tolist(), strict=True))


def _bars(
    ax: Axes, row: float, spans: Iterable[tuple[int, int]], color: str, alpha: float = 1
) -> None:
    pieces = [(start / SECOND, (stop - start) / SECOND) for start, stop in spans]
    ax.broken_barh(pieces, (row - 0.32, 0.64), facecolors=color, alpha=alpha, lw=0)


def _life(ax: Axes, run: Run) -> None:
    """Of the image, in both channels."""
    end = run.trace.end
    for channel, color, style in zip(run.channels, FPGAS, ("-", "--"), strict=True):
        wave = channel.wave("life")
        times = np.append(wave.ticks, end) / SECOND
        lives = np.append(wave.values, wave.values[-1])
        ax.step(times, lives, style, where="post", color=color, lw=1.4)
    most = run.config.life_cycles
    ax.set_yticks(range(0, most + 1, 1 + most // 5))
    ax.set_ylim(-0.3, most + 0.3)
    ax.set_ylabel("life / cycles")


def _causes(ax: Axes, run: Run, causes: Sequence[Cause]) -> None:
    """A mark for each time that an FPGA counted it: FPGA 1's above, FPGA 2's below."""
    for row, cause in enumerate(causes):
        for channel, color, above in zip(run.channels, FPGAS, (0.18, -0.18), strict=True):
            at = [at / SECOND for at, _ in channel.counted(cause.name.lower())]
            ax.plot(at, [row - above] * len(at), "|", color=color, ms=6, mew=1.2)
    _rows(ax, [cause.name.lower().replace("_", " ") for cause in causes])
    ax.set_ylabel("causes")
