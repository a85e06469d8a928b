"""The page: its template filled with what a run came to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from railgate.unit.conditions import broken
from railgate.unit.events import Event
from railgate.unit.excerpts import Excerpts
from railgate.unit.report.charts import charts
from railgate.unit.report.facts import facts, figures, visits
from railgate.unit.result import Result
from railgate.unit.table import tone
from railgate.waves import replacing

__all__ = ["page", "write_report"]

ROWS = 3_000
"""Events in the page; files have all of them."""
SOURCES = {
    "FPGA 1": "blue",
    "odometer 1": "blue",
    "FPGA 2": "orange",
    "odometer 2": "orange",
    "fault": "magenta",
    "relay": "ink",
    "position link": "violet",
    "CPUs": "green",
}
"""The colours of those that tell of events; grey is that of all others."""
PLACES = ("soft", "magenta")
"""The colours of platforms and faults in lanes."""


def write_report(result: Result, path: Path) -> None:
    """Write the page, whole or not at all. Raises ValueError."""
    with replacing(path) as new:
        new.write_text(page(result), encoding="utf-8")


def page(result: Result) -> str:
    """The whole page as HTML."""
    made = Environment(
        loader=PackageLoader("railgate.unit.report", "."),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    told = charts(result)
    return made.get_template("page.html").render(
        result=result,
        scenario=result.run.scenario,
        engine=result.run.engine,
        verdict=result.verdict,
        declared=f"{float(result.verdict.declared_s) * 1e3:.1f} ms",
        figures=list(figures(result)),
        calls=visits(result.run),
        injected=result.injected,
        broken=broken(result.run.scenario),
        shown=_rows(result),
        unseen=max(len(result.events) - ROWS, 0),
        sources=list(dict.fromkeys(event.source for event in result.events)),
        facts=list(facts(result)),
        charts=told,
        each=told["each"],
        key=_key(told["lanes"]),
        at=at,
        delay=delay,
        tone=tone,
        source_tone=lambda source: SOURCES.get(source, "grey"),
        styles=Markup(_text("vendor/uPlot.min.css") + _text("style.css")),
        uplot=Markup(f"/*\n{_text('vendor/LICENSE')}*/\n{_text('vendor/uPlot.iife.min.js')}"),
        script=Markup(_text("charts.js")),
    )


def _key(lanes: Sequence[Mapping[str, Any]]) -> list[tuple[str, str]]:
    """What the colours of the lanes mean, but for places and faults, whose names differ."""
    told = [span[2:] for lane in lanes for span in lane["spans"] if span[3] not in PLACES]
    return list(dict.fromkeys(told))


def _rows(result: Result) -> list[tuple[Event, str | None]]:
    """The first events, each with the name of its waves."""
    of = result.excerpts.of[:ROWS]
    names = [None if number is None else Excerpts.name(number) for number in of]
    return list(zip(result.events, names, strict=False))


def _text(name: str) -> str:
    return resources.files(__package__).joinpath(name).read_text("utf-8")


def at(time_s: float, digits: int = 3) -> str:
    """A time in the run, s."""
    return f"{time_s:.{digits}f}"


def delay(time_s: float) -> str:
    """How long after, as `+7.2 ms` or `+2.05 s`."""
    return f"+{time_s * 1e3:.1f} ms" if time_s < 1 else f"+{time_s:.2f} s"
