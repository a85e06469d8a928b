"""A run of the unit as a person reads it in a terminal."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from railgate.position_link.host import summary
from railgate.unit.conditions import broken
from railgate.unit.events import Event
from railgate.unit.findings import Injected
from railgate.unit.result import Result
from railgate.unit.scenario import Scenario
from railgate.unit.window import Replayed

__all__ = ["show", "show_scenarios", "tone"]

ROWS = 40
"""Events of a summary; the report and the files have all."""
TONES = (
    ("", (" again", "adhering")),
    ("red", ("alarm", "forced to 0", "longer than declared", "without a live 1", "upset")),
    ("amber", ("rejected", "failed", "lost", "warning", "off its", "not trusted", "axle")),
    ("green", ("contact closes",)),
)
"""The first that has a word of the text colours it."""
STYLES = {"red": "red", "amber": "yellow", "green": "green", "magenta": "magenta", "": ""}
ROUTINE = ("test of the shut-off", "→", "time trusted", "begins a sequence", "may drive", "up")
"""Words of what goes well and every time alike: in the report, not in the summary."""


def tone(event: Event) -> str:
    """The colour of an event: magenta of a fault, else by how bad it is; empty for nothing."""
    if event.source == "fault":
        return "magenta"
    return next((name for name, words in TONES if any(w in event.what for w in words)), "")


def show(result: Result) -> RenderableType:
    """What happened, how faults were found, and the run in figures."""
    parts: list[RenderableType] = [_events(result.events)]
    if result.injected:
        parts.append(_faults(result.injected))
    return Group(*parts, _grid(_figures(result)))


def show_scenarios(scenarios: Iterable[tuple[str, Scenario]]) -> RenderableType:
    """Those that are built in."""
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for name in ("scenario", "what it is", "unit"):
        table.add_column(name)
    for name in ("s", "m", "stops", "faults"):
        table.add_column(name, justify="right")
    for name, each in scenarios:
        stops = each.route.stops
        way = stops[-1].at_m - stops[0].at_m
        figures = (f"{float(each.seconds):.0f}", f"{way:.0f}", str(len(stops)))
        table.add_row(Text(name, "bold"), each.name, each.unit, *figures, str(len(each.faults)))
    return table


def _events(events: Sequence[Event]) -> Table:
    table = Table(box=SIMPLE_HEAD, pad_edge=False, caption_justify="left")
    table.add_column("t/s", justify="right", no_wrap=True)
    table.add_column("", no_wrap=True)
    table.add_column("what happens", overflow="fold")
    table.add_column("km/h", justify="right", no_wrap=True)
    table.add_column("m", justify="right", no_wrap=True)
    telling = [event for event in events if tone(event) or not _routine(event)]
    for event in telling[:ROWS]:
        table.add_row(
            f"{event.time_s:.3f}",
            Text(event.source),
            Text(event.what, STYLES[tone(event)]),
            "" if event.speed_kmh is None else f"{event.speed_kmh:.1f}",
            "" if event.place_m is None else f"{event.place_m:.1f}",
        )
    rest = len(events) - min(len(telling), ROWS)
    table.caption = f"and {rest} events more in the report" if rest else None
    return table


def _routine(event: Event) -> bool:
    return any(word in event.what for word in ROUTINE)


def _faults(faults: Sequence[Injected]) -> Table:
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    table.add_column("fault", style="magenta")
    table.add_column("from/s", justify="right", no_wrap=True)
    table.add_column("told by the unit, and how long after its begin", overflow="fold")
    for fault in faults:
        told = "\n".join(
            f"{each.source} +{each.delay_s:.3f} s: {each.what}" for each in fault.found
        )
        table.add_row(fault.what, f"{fault.start_s:.3f}", told or Text("nothing", "yellow"))
    return table


def _figures(result: Result) -> list[tuple[str, RenderableType]]:
    run, scenario = result.run, result.run.scenario
    told = summary(run.link.told)
    outside = result.speed_interval_violations
    return [
        (
            "scenario",
            f"{scenario.name} ({result.name}), seed {scenario.seed}, {float(scenario.seconds):g} s",
        ),
        (
            "speed",
            Text(
                f"truth outside the interval in {outside} of {run.cycles.times_s.size} cycles",
                "yellow" if outside else "",
            ),
        ),
        ("distance", f"off by {result.distance_error_m:+.3f} m at the end"),
        ("position", f"word there in {100 * told.availability:.2f} % of {told.deliveries} cycles"),
        ("reaction", _reaction(result)),
        *(("not kept", Text(premise, "yellow")) for premise in broken(scenario)),
        ("engine", f"{run.engine}, {run.real_time_factor:.1f} × real time"),
        *(("in RTL", _window(each)) for each in result.windows),
        ("verdict", _verdict(result)),
    ]


def _reaction(result: Result) -> str:
    verdict = result.run.vital.verdict
    told = [f"declared {_ms(verdict.declared_s)}"]
    for why, text in (("failure", "by a failure"), ("command", "by command")):
        worst = verdict.worst_s(why)
        told.append(f"{text} {'not seen' if worst is None else f'at most {_ms(worst)}'}")
    return "; ".join(told)


def _window(each: Replayed) -> Text:
    warm = f"{each.function}, from {float(each.warm_s):.3f} s on, {each.ticks} ticks"
    if each.difference is None:
        return Text(f"{warm}: all outputs as the model's", "green")
    return Text(f"{warm}: not as the model's: {each.difference}", "bold red")


def _verdict(result: Result) -> Text:
    if result.verdict.safe:
        return Text("safe: no door contact was closed where and when it must not be", "bold green")
    return Text("not safe: " + "; ".join(result.verdict.reasons), "bold red")


def _ms(time_s: Fraction) -> str:
    return f"{float(time_s) * 1e3:.1f} ms"


def _grid(rows: Iterable[tuple[str, RenderableType]]) -> Table:
    grid = Table.grid(padding=(0, 2))
    for name, text in rows:
        grid.add_row(Text(name, style="bold"), text)
    return grid
