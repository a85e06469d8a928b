"""A run of the link as a picture: health, age and causes over time, and one cycle's pins."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from railgate.position_link.simulate import Run
from railgate.position_link.spec import Health, cause_names
from railgate.waves import Waveform, replacing

__all__ = ["draw"]

BLUE, RED, GREY = "#2a6fbb", "#c23b3b", "#8a8f98"
HEALTH = {
    Health.START: ("start", "#b9bec6"),
    Health.OK: ("ok", "#4f9d69"),
    Health.WARNING: ("warning", "#e0b13c"),
    Health.ALARM: ("alarm", RED),
    Health.RECOVERING: ("recovering", "#5aa6c9"),
}
CAUSES = cause_names()
PINS = ("clk", "anf", "uef", "data", "radio_valid", "radio_data")


def draw(run: Run, path: Path) -> None:
    """Draw into a PNG file, which is there whole or not. Raises ValueError."""
    raised = int(np.bitwise_or.reduce(run.deliveries.fields["causes"], initial=0))
    causes = cause_names(raised)
    figure = Figure(figsize=(11, 8.5), layout="constrained", dpi=110)
    heights = (0.5, 1.4, 0.3 + 0.2 * max(1, len(causes)))
    parts: Any = figure.subfigures(2, 1, height_ratios=(1.2, 1))
    history, pins = parts
    axes = history.subplots(len(heights), 1, sharex=True, height_ratios=heights)
    times = run.deliveries.ticks / run.config.clock_hz
    _health(axes[0], run, times)
    _age(axes[1], run, times)
    _causes(axes[2], run, times, causes)
    axes[-1].set_xlabel("time / s")
    _pins(pins.subplots(), run)
    for ax in (*axes, *pins.axes):
        ax.spines[["top", "right"]].set_visible(False)
        ax.margins(x=0.01)
    history.align_ylabels(axes)
    figures = run.summary
    figure.suptitle(
        f"{figures.fresh} fresh, {figures.held} held, {figures.fault} fault words in "
        f"{run.cycles} cycles  ·  {run.engine}, {run.config.clock_hz / 1e6:g} MHz",
        fontsize=11,
    )
    with replacing(path) as new:
        figure.savefig(new, format="png")


def _health(ax: Axes, run: Run, times: np.ndarray) -> None:
    """A coloured strip: the health from each delivery to the next."""
    cycle_s = float(run.config.cycle_s)
    health = run.deliveries.fields["health"]
    turns = np.flatnonzero(np.diff(health, prepend=health[0] + 1))
    ends = np.append(times[turns[1:]], times[-1] + cycle_s)
    for start, end, code in zip(times[turns], ends, health[turns], strict=True):
        ax.axvspan(start, end, color=HEALTH[Health(int(code))][1], lw=0)
    seen = [HEALTH[Health(int(code))] for code in np.unique(health)]
    ax.legend(
        handles=[Patch(color=color, label=label) for label, color in seen],
        loc="lower left",
        bbox_to_anchor=(0, 1),
        ncols=len(seen),
        fontsize=8,
        frameon=False,
    )
    ax.set_yticks([])
    ax.set_ylabel("health")


def _age(ax: Axes, run: Run, times: np.ndarray) -> None:
    """The age of the word that was delivered, where there was one."""
    age_ms = np.where(run.deliveries.believed, run.deliveries.age_s * 1e3, np.nan)
    ax.plot(times, age_ms, "." if len(times) < 400 else ",", color=BLUE, ms=5)
    ax.set_ylim(bottom=-0.05 * max(np.nanmax(age_ms, initial=0), 1))
    ax.set_ylabel("age of word / ms")
    ax.grid(alpha=0.25)


def _causes(ax: Axes, run: Run, times: np.ndarray, causes: tuple[str, ...]) -> None:
    raised = run.deliveries.fields["causes"]
    for row, name in enumerate(causes):
        at = times[(raised >> CAUSES.index(name) & 1).astype(bool)]
        ax.plot(at, np.full(at.size, row), "|", color=RED, ms=7, mew=1.2)
    ax.set_yticks(range(len(causes)), [name.replace("_", " ") for name in causes], fontsize=8)
    ax.set_ylim(max(len(causes), 1) - 0.5, -0.5)
    ax.set_ylabel("causes")
    ax.grid(alpha=0.25)


def _pins(ax: Axes, run: Run) -> None:
    """Request, answer and frame of the first faulty cycle that is kept, else of the first."""
    config = run.config
    whole = run.waves.end // config.cycle_ticks
    faulty = np.flatnonzero(run.deliveries.fields["causes"][:whole])
    cycle = int(faulty[0]) if faulty.size else 0
    start = 1 + cycle * config.cycle_ticks
    span = config.rise(min(config.radio_first + config.frame_bits + 4, config.cycle_bits))
    part = run.waves.slice(start, min(start + span, run.waves.end))
    scale = 1e6 / config.clock_hz
    for row, name in enumerate(PINS):
        _step(ax, part[name], part.end, start, scale, -1.4 * row)
    ax.axvline(config.delivery_ticks * scale, color=GREY, lw=1, ls=":")
    ax.annotate(
        "delivery",
        (config.delivery_ticks * scale, 1.15),
        ha="center",
        fontsize=8,
        color=GREY,
        annotation_clip=False,
    )
    ax.set_yticks([0.4 - 1.4 * row for row in range(len(PINS))], PINS, fontsize=8)
    raised = cause_names(int(run.deliveries.fields["causes"][cycle]))
    told = ", ".join(raised).replace("_", " ") or "good"
    ax.set_xlabel(f"time in cycle {cycle + 1} ({told}) / µs")


def _step(ax: Axes, wave: Waveform, end: int, start: int, scale: float, base: float) -> None:
    """One pin, from 0 to 0.8 above its base."""
    times = (np.append(wave.ticks, end) - start) * scale
    levels = np.append(wave.values, wave.values[-1]).astype(float)
    ax.step(times, base + 0.8 * levels, where="post", color=BLUE, lw=0.8)
