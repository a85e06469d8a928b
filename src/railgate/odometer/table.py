"""A measurement as a person reads it in a terminal."""

from __future__ import annotations

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from railgate.odometer.measure import Measurement, Window

__all__ = ["show"]

ROWS = 30


def show(measurement: Measurement) -> RenderableType:
    """The windows, at most some thirty of them evenly chosen, and the summary."""
    step = -(-len(measurement.windows) // ROWS)
    return Group(_windows(measurement.windows[::step], step), _summary(measurement))


def _windows(windows: tuple[Window, ...], step: int) -> Table:
    caption = f"one window in {step} is shown; --out and --json have all" if step > 1 else None
    table = Table(caption=caption, caption_justify="left", box=SIMPLE_HEAD, pad_edge=False)
    fine = len(windows) > 1 and windows[1].t_s - windows[0].t_s < 1e-3
    digits = 6 if fine else 3
    truth = any(window.true_speed_kmh is not None for window in windows)
    for name in ("t/s", "km/h", "at least", "at most", *(["truly"] if truth else [])):
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("direction", no_wrap=True)
    for name in ("pulses", "period", "phase/°"):
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("flags", style="yellow")
    for window in windows:
        true = [_number(window.true_speed_kmh, 4)] if truth else []
        table.add_row(
            f"{window.t_s:.{digits}f}",
            _number(window.speed_kmh, 4),
            _number(window.speed_low_kmh, 4),
            _number(window.speed_high_kmh, 4),
            *true,
            window.direction,
            str(window.pulses),
            "" if window.period_ticks is None else str(window.period_ticks),
            _number(window.phase_deg, 2),
            ", ".join(flag.replace("_", " ") for flag in window.flags),
        )
    return table


def _number(value: float | None, digits: int) -> str:
    return "" if value is None else f"{value:.{digits}f}"


def _summary(m: Measurement) -> Table:
    grid = Table.grid(padding=(0, 2))
    rows = [
        ("engine", f"{m.engine}, {m.clock_hz / 1e6:g} MHz, {m.duration_s:g} s"),
        ("rising edges", f"a {m.a_rising}, b {m.b_rising}"),
        ("position", f"{m.position_x4:+d} quarter pitches, {m.distance_m:+.3f} m"),
        (
            "on the way",
            f"{m.direction_changes} direction changes, {m.illegal_transitions} illegal "
            f"transitions, {m.rejected_glitches} rejected glitches",
        ),
        ("guaranteed", f"{m.guarantee} ({m.estimator})"),
        ("resting on", "; ".join(m.rests_on)),
    ]
    if (outside := m.truth_outside) is not None:
        told = "" if not outside else f", {m.truth_outside_flagged} of them flagged"
        rows.append(("truth", f"outside the guaranteed interval in {outside} windows{told}"))
    for name, text in rows:
        grid.add_row(Text(name, style="bold"), text)
    return grid
