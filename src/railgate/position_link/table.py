"""A run of the link, and a captured line, as a person reads them in a terminal."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from itertools import groupby

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from railgate.position_link.host import Delivery, Layout
from railgate.position_link.simulate import Run
from railgate.position_link.spec import Health

__all__ = ["show"]

ROWS = 60
"""At most so many rows of a run."""
ALIKE = 4
"""Longer stretches of cycles that say the same are cut to their ends."""

STYLES = {
    Health.START: "dim",
    Health.OK: "green",
    Health.WARNING: "yellow",
    Health.ALARM: "red",
    Health.RECOVERING: "cyan",
}


def show(run: Run) -> RenderableType:
    """The cycles, of long stretches alike only the ends, and the figures of the run."""
    return Group(_cycles(run), _figures(run))


def _cycles(run: Run) -> Table:
    layout = run.deliveries.layout
    fields = [] if layout is None else [field.name for field in layout.fields]
    table = Table(box=SIMPLE_HEAD, pad_edge=False, caption_justify="left")
    for name in ("t/s", "number"):
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("word", no_wrap=True)
    table.add_column("status", no_wrap=True)
    for name in ("age", "age/ms"):
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("health", no_wrap=True)
    for name in fields:
        table.add_column(_heading(name, layout), justify="right", no_wrap=True)
    table.add_column("causes", style="yellow")
    rows = 0
    for shown, alike in _stretches(run.deliveries):
        if rows >= ROWS:
            table.caption = f"the first {rows} rows; --out and --json have all cycles"
            break
        rows += len(shown)
        for at, each in enumerate(shown):
            if at == len(shown) - 1 and alike:
                table.add_row("", "", Text(f"… {alike} more alike …", "dim"))
            table.add_row(*_row(each, run.config.word_bits, fields))
    return table


def _heading(name: str, layout: Layout | None) -> str:
    units = {field.name: field.unit for field in layout.fields} if layout else {}
    return f"{name}/{units[name]}" if units.get(name) else name


def _stretches(cycles: Iterable[Delivery]) -> Iterator[tuple[list[Delivery], int]]:
    """The ends of each stretch of cycles that say the same, and how many lie between them."""
    for _, group in groupby(cycles, key=lambda each: (each.status, each.health, each.causes)):
        alike = list(group)
        if len(alike) <= ALIKE:
            yield alike, 0
        else:
            yield [alike[0], alike[-1]], len(alike) - 2


def _row(each: Delivery, word_bits: int, fields: Iterable[str]) -> list[str | Text]:
    return [
        f"{each.time_s:.6f}",
        str(each.number),
        hexadecimal(each.word, word_bits),
        each.status.name.lower(),
        str(each.age),
        "" if each.age_s is None else f"{each.age_s * 1e3:.3f}",
        Text(each.health.name.lower(), STYLES[each.health]),
        *(_value(each.values, name) for name in fields),
        ", ".join(cause.replace("_", " ") for cause in each.causes),
    ]


def hexadecimal(word: int, word_bits: int) -> str:
    """The word in full, or the first and last digits of a long one."""
    digits = f"{word:0{-(-word_bits // 4)}x}"
    return digits if len(digits) <= 16 else f"{digits[:8]}…{digits[-6:]}"


def _value(values: Mapping[str, float], name: str) -> str:
    return f"{values[name]:.10g}" if name in values else ""


def _figures(run: Run) -> Table:
    config, figures = run.config, run.summary
    kinds = ", ".join(
        f"{count} {cause.replace('_', ' ')}" for cause, count in figures.causes.items() if count
    )
    oldest = "none" if figures.oldest_s is None else f"{figures.oldest_s * 1e3:.3f} ms"
    grid = Table.grid(padding=(0, 2))
    for name, text in (
        (
            "engine",
            f"{run.engine}, {config.clock_hz / 1e6:g} MHz, CLK {float(config.bit_rate_hz) / 1e3:g} "
            f"kHz = clock · {config.bits}/{config.ticks}, {run.cycles} cycles of "
            f"{config.cycle_ticks} ticks",
        ),
        (
            "delivered",
            f"{figures.fresh} fresh, {figures.held} held, {figures.fault} fault words: "
            f"{100 * figures.availability:.6g} % with a word",
        ),
        ("faulty cycles", f"{figures.faulty_cycles}" + (f" ({kinds})" if kinds else "")),
        ("glitches", f"{figures.rejected_glitches} rejected by the filters"),
        (
            "alarms",
            f"{figures.alarms}, the longest {figures.longest_alarm_s * 1e3:g} ms"
            if figures.alarms
            else "none",
        ),
        ("oldest word", f"{oldest}, from UEF's rise to the delivery"),
        ("radio unit", f"{run.radio_frames} frames right, {run.radio_faults} wrong"),
        ("check", figures.guarantee),
    ):
        grid.add_row(Text(name, style="bold"), text)
    return grid
