"""A run of the link, and a captured line, as a person reads them in a terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from railgate.position_link.decode import Decoded
from railgate.position_link.host import Delivery, Layout, guarantee
from railgate.position_link.model import Answer
from railgate.position_link.simulate import Run
from railgate.position_link.spec import Health, cause_names

__all__ = ["show", "show_decoded"]

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
    return Group(_cycles(run), _grid(_figures(run)))


def show_decoded(found: Decoded) -> RenderableType:
    """The answers, of long stretches alike only the ends, and the figures of the capture."""
    return Group(_answers(found), _grid(_findings(found)))


def _cycles(run: Run) -> Table:
    layout = run.deliveries.layout
    fields = [] if layout is None else [field.name for field in layout.fields]
    table = Table(box=SIMPLE_HEAD, pad_edge=False, caption_justify="left")
    table.add_column("t/s", justify="right", no_wrap=True)
    for name in ("word", "status"):
        table.add_column(name, no_wrap=True)
    table.add_column("age/ms", justify="right", no_wrap=True)
    table.add_column("health", no_wrap=True)
    table.add_column("causes", style="yellow", min_width=6, overflow="fold")
    for name in fields:
        table.add_column(_heading(name, layout), justify="right", no_wrap=True)
    told = run.deliveries.fields
    alike = _alike(told["status"], told["health"], told["causes"])
    _fill(table, alike, lambda i: _row(run.deliveries[i], run.config.word_bits, fields))
    return table


def _answers(found: Decoded) -> Table:
    fields = [] if found.layout is None else [field.name for field in found.layout.fields]
    table = Table(box=SIMPLE_HEAD, pad_edge=False, caption_justify="left")
    table.add_column("t/s", justify="right", no_wrap=True)
    table.add_column("word", no_wrap=True)
    table.add_column("bits", justify="right", no_wrap=True)
    table.add_column("causes", style="yellow", min_width=6, overflow="fold")
    for name in fields:
        table.add_column(_heading(name, found.layout), justify="right", no_wrap=True)
    alike = _alike(found.reading.causes)
    _fill(table, alike, lambda i: _answer(found, found.answers[i], fields))
    return table


def _answer(found: Decoded, answer: Answer, fields: Iterable[str]) -> list[str | Text]:
    values = found.values(answer)
    return [
        f"{found.time_s(answer.tick):.6f}",
        "" if answer.word is None else hexadecimal(answer.word, found.config.word_bits),
        str(answer.bits),
        _causes(cause_names(answer.causes)),
        *(_value(values, name) for name in fields),
    ]


def _alike(*columns: NDArray[Any]) -> Iterator[range]:
    """The stretches of rows over which none of these columns changes."""
    changes = np.any([column[1:] != column[:-1] for column in columns], axis=0)
    ends = [0, *(np.flatnonzero(changes) + 1).tolist(), columns[0].size]
    return (range(start, end) for start, end in pairwise(ends))


def _fill(
    table: Table, stretches: Iterable[range], row: Callable[[int], Iterable[str | Text]]
) -> None:
    """The rows of each stretch, of a long one its ends."""
    for stretch in stretches:
        if table.row_count >= ROWS:
            table.caption = "this is the beginning; --out and --json have all"
            return
        left = len(stretch) - 2 if len(stretch) > ALIKE else 0
        for i in stretch[:1] if left else stretch:
            table.add_row(*row(i))
        if left:
            table.add_row("", Text(f"… {left} alike …", "dim"))
            table.add_row(*row(stretch[-1]))


def _heading(name: str, layout: Layout | None) -> str:
    units = {field.name: field.unit for field in layout.fields} if layout else {}
    return f"{name}/{units[name]}" if units.get(name) else name


def _row(each: Delivery, word_bits: int, fields: Iterable[str]) -> list[str | Text]:
    return [
        f"{each.time_s:.6f}",
        hexadecimal(each.word, word_bits),
        each.status.name.lower(),
        "" if each.age_s is None else f"{each.age_s * 1e3:.3f}",
        Text(each.health.name.lower(), STYLES[each.health]),
        _causes(each.causes),
        *(_value(each.values, name) for name in fields),
    ]


def hexadecimal(word: int, word_bits: int) -> str:
    """The word in full, or the first and last digits of a long one."""
    digits = f"{word:0{-(-word_bits // 4)}x}"
    return digits if len(digits) <= 16 else f"{digits[:8]}…{digits[-6:]}"


def _causes(names: Iterable[str]) -> str:
    return ", ".join(names).replace("_", " ")


def _value(values: Mapping[str, float], name: str) -> str:
    return f"{values[name]:.10g}" if name in values else ""


def _figures(run: Run) -> list[tuple[str, str]]:
    config, figures = run.config, run.summary
    alarms, starting = "none", ""
    if figures.alarms:
        alarms = f"{figures.alarms}, the longest {figures.longest_alarm_s * 1e3:g} ms"
    if figures.starting:
        starting = f"; {figures.starting} deliveries at the start without a good word yet"
    oldest = "none delivered"
    if figures.oldest_s is not None:
        oldest = f"{figures.oldest_s * 1e3:.3f} ms, from UEF's rise to the delivery"
    return [
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
        ("faulty cycles", f"{figures.faulty_cycles}{_kinds(figures.causes)}"),
        ("glitches", f"{figures.rejected_glitches} rejected by the filters"),
        ("alarms", f"{alarms}{starting}"),
        ("oldest word", oldest),
        ("radio unit", f"{run.radio_frames} frames right, {run.radio_faults} wrong"),
        ("check", figures.guarantee),
    ]


def _findings(found: Decoded) -> list[tuple[str, str]]:
    reading, wanted = found.reading, float(found.config.bit_rate_hz) / 1e3
    rate = "it never runs"
    if reading.bit_rate_hz is not None:
        rate = f"{reading.bit_rate_hz / 1e3:.6g} kHz in the mean, it stopped {reading.clock_stops}×"
    faulty = len(found.answers) - found.good
    return [
        ("capture", f"{float(found.line.duration_s):g} s, ticks of {found.line.period} s"),
        ("CLK", f"{rate}; {wanted:g} kHz expected"),
        ("judged by", "captured requests" if reading.requests else "UEF alone, no ANF"),
        ("good words", f"{found.good}"),
        ("faulty", f"{faulty}{_kinds(found.counts)}"),
        ("cut off", f"{reading.cut} at the ends of the capture"),
        ("check", guarantee(found.config.check)),
    ]


def _kinds(counts: Mapping[str, int]) -> str:
    kinds = [f"{count} {cause.replace('_', ' ')}" for cause, count in counts.items() if count]
    return f" ({', '.join(kinds)})" if kinds else ""


def _grid(rows: Iterable[tuple[str, str]]) -> Table:
    grid = Table.grid(padding=(0, 2))
    for name, text in rows:
        grid.add_row(Text(name, style="bold"), text)
    return grid
