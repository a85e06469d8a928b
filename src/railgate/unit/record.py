"""A run of the unit as a folder of files, from which it can be run again."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from functools import partial
from pathlib import Path

import numpy as np

from railgate.records import Columns, tables, write_folder
from railgate.unit.events import Event
from railgate.unit.excerpts import Excerpts
from railgate.unit.log import Log
from railgate.unit.report import write_report
from railgate.unit.result import Result
from railgate.unit.run import Cycles
from railgate.unit.waves import GROUPS, waves
from railgate.waves import Trace, replacing, write_gtkw, write_vcd

__all__ = ["record"]

EVENT = tuple(field.name for field in fields(Event))
WAVES = "waves"
REPORT = "report.html"
OURS = re.compile(r"\d{3,}\.(vcd|gtkw)")
"""Waves of a run before, in the same folder."""


def record(result: Result, folder: Path) -> list[Path]:
    """Write all files into `folder`, see `write_folder`; returns their paths, the report first.

    A run before that is there gives way to this one. The report is written last, so that where
    there is one, all that it speaks of is there. Raises ValueError.
    """
    _clear(folder)
    spans = result.excerpts.spans
    excerpts = waves(result.run, spans)
    writers: dict[str, Callable[[Path], None]] = {}
    for number in range(len(spans)):
        writers |= _excerpt(Excerpts.name(number), partial(next, excerpts))
    paths = write_folder(folder / WAVES, writers)
    told, cycles = result.as_json(), tables("cycles", _columns(result.run.cycles))
    paths += write_folder(
        folder,
        {
            "cycles.parquet": cycles["cycles.parquet"],
            **tables("events", _events(told["events"])),
            "events.jsonl": partial(_log, result),
            "scenario.toml": partial(_write, result.text),
            "run.json": partial(_write, f"{_json(told)}\n"),
            REPORT: partial(write_report, result),
        },
    )
    return [paths[-1], *paths[:-1]]


def _clear(folder: Path) -> None:
    try:
        (folder / REPORT).unlink(missing_ok=True)
        for path in (folder / WAVES).glob("*"):
            if OURS.fullmatch(path.name):
                path.unlink()
    except OSError as error:
        raise ValueError(f"{folder} cannot be written: {error.strerror}") from None


def _excerpt(name: str, take: Callable[[], Trace]) -> dict[str, Callable[[Path], None]]:
    """The writers of a VCD and of the file that shows it: the first takes what both need."""
    taken: list[Trace] = []

    def vcd(path: Path) -> None:
        taken.append(take())
        write_vcd(path, taken[0])

    def gtkw(path: Path) -> None:
        trace = taken.pop()
        shown = {
            title: [signal for signal in trace.signals if signal.startswith(begins)]
            for title, begins in GROUPS.items()
        }
        write_gtkw(path, f"{name}.vcd", trace, shown)

    return {f"{name}.vcd": vcd, f"{name}.gtkw": gtkw}


def _columns(cycles: Cycles) -> Columns:
    """Each of the cycles' columns by its name; of several in one, with FPGA and axle behind it."""
    found: dict[str, list[object]] = {}
    for field in fields(cycles):
        column = getattr(cycles, field.name)
        for index in np.ndindex(column.shape[1:]):
            name = "_".join([field.name, *(str(i + 1) for i in index)])
            found[name] = column[(slice(None), *index)].tolist()
    return found


def _events(told: Sequence[Mapping[str, object]]) -> Columns:
    return {name: [event[name] for event in told] for name in (*EVENT, "waves")}


def _json(told: object) -> str:
    return json.dumps(told, ensure_ascii=False, allow_nan=False, indent=1)


def _log(result: Result, path: Path) -> None:
    with replacing(path) as new, Log(new) as log:
        log.append(*result.events)


def _write(text: str, path: Path) -> None:
    with replacing(path) as new:
        new.write_text(text, encoding="utf-8")
