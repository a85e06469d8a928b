"""A run of the vital output as a person reads it in a terminal."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from railgate.vital_output.observed import Observed
from railgate.vital_output.simulate import Run
from railgate.vital_output.situations import SITUATIONS
from railgate.vital_output.spec import CAUSES, Cause, State
from railgate.vital_output.timeline import NAMES, Event, folded, named, seconds
from railgate.vital_output.verdict import Verdict

__all__ = ["show", "show_situations"]

ROWS = 400
"""At most so many rows of a timeline."""

SOURCES = {"FPGA 1": "blue", "FPGA 2": "dark_orange", "relay": "bold", "fault": "magenta"}
STYLES = (
    ("red", ("alarm", "forced to 0", "longer than declared", "without a live 1", "upset")),
    ("yellow", ("rejected", "failed", "lost", "→ 1", "→ 2", "off ", "not trusted", "latched")),
    ("green", ("closes", "stored", "passed", "up", "accepted")),
)
"""The first that has a word of the text colours it."""


def show(run: Run) -> RenderableType:
    """What happened, and the run in figures."""
    return Group(_timeline(run), _grid(_figures(run)))


def show_situations() -> RenderableType:
    """What each of the built-in situations is."""
    return _grid((name, situation.does) for name, situation in SITUATIONS.items())


def _timeline(run: Run) -> Table:
    table = Table(box=SIMPLE_HEAD, pad_edge=False, caption_justify="left")
    table.add_column("t/s", justify="right", no_wrap=True)
    table.add_column("", no_wrap=True)
    table.add_column("what happens", overflow="fold")
    events = folded(run.events, run.config.cycle_s)
    for event in events[:ROWS]:
        table.add_row(*_row(event))
    if len(events) > ROWS:
        table.caption = "this is the beginning; --out and --json have all"
    return table


def _row(event: Event) -> tuple[str | Text, ...]:
    if not event.source:
        return "", "", Text(event.what, "dim")
    style = next((s for s, words in STYLES if any(word in event.what for word in words)), "")
    if event.source == "fault":
        style = SOURCES["fault"]
    source = Text(event.source, SOURCES.get(event.source, ""))
    return seconds(event.time_s), source, Text(event.what, style)


def _figures(run: Run) -> list[tuple[str, RenderableType]]:
    config, scenario = run.config, run.scenario
    return [
        (
            "engine",
            f"{run.engine}, {config.outputs} outputs, {config.clock_hz / 1e6:g} MHz at "
            f"{float(scenario.ppm_1):+g} and {float(scenario.ppm_2):+g} ppm, cycles of "
            f"{float(config.cycle_s) * 1e3:g} ms, {float(scenario.seconds):g} s",
        ),
        *((f"FPGA {channel.fpga}", _channel(channel)) for channel in run.channels),
        ("contacts", _contacts(run.verdict)),
        ("reaction", _reaction(run.verdict)),
        ("verdict", _verdict(run.verdict)),
    ]


def _channel(channel: Observed) -> str:
    """What it took, what went wrong, and how it ends."""
    names = ("accepted", "lost", "passed", "stored")
    taken, lost, passed, stored = (channel.total(name) for name in names)
    wrong = {cause.name.lower(): channel.total(cause.name.lower()) for cause in CAUSES}
    told = ", ".join(f"{count} {name.replace('_', ' ')}" for name, count in wrong.items() if count)
    first = Cause(int(channel.wave("first_cause").values[-1]))
    since = (
        f"; the first since the last acknowledgement: {first.name.lower().replace('_', ' ')}"
        if first
        else ""
    )
    return (
        f"{taken} frames accepted, {lost} lost, {passed} votes passed, {stored} images stored\n"
        f"causes: {told or 'none'}{since}\n"
        f"at the end: {_states(channel)}"
    )


def _states(channel: Observed) -> str:
    """The state of each output at the run's end, those alike together."""
    states: dict[State, int] = {}
    for output in range(channel.config.outputs):
        state = State(int(channel.state(output).values[-1]))
        states[state] = states.get(state, 0) | 1 << output
    return ", ".join(f"{named(outputs)} {NAMES[state]}" for state, outputs in states.items())


def _contacts(verdict: Verdict) -> str:
    if not verdict.closings:
        return "never closed"
    late = sum(each.late for each in verdict.closings)
    lasting = sum(each.lasts for each in verdict.closings)
    return (
        f"closed {len(verdict.closings)} ×"
        f"{f', {late} × without a live 1' if late else ''}"
        f"{f', {lasting} still closed at the end' if lasting else ''}"
    )


def _reaction(verdict: Verdict) -> str:
    """How long after the last agreed, live 1 a contact opened, at most."""
    told = [f"declared {_ms(verdict.declared_s)}"]
    for why, text in (("failure", "by a failure"), ("command", "by command")):
        worst = verdict.worst_s(why)
        told.append(f"{text} {'not seen' if worst is None else f'at most {_ms(worst)}'}")
    return "; ".join(told)


def _verdict(verdict: Verdict) -> Text:
    if not verdict.violations:
        return Text("no contact was closed longer than declared after the last live 1", "green")
    worst = max(each.unbacked_s for each in verdict.violations)
    outputs = 0
    for each in verdict.violations:
        outputs |= 1 << each.output
    return Text(
        f"{named(outputs)}: closed for {_ms(worst)} without a live 1, {_ms(verdict.declared_s)} "
        "are declared",
        "bold red",
    )


def _ms(time_s: Fraction) -> str:
    return f"{float(time_s) * 1e3:.3f} ms"


def _grid(rows: Iterable[tuple[str, RenderableType]]) -> Table:
    grid = Table.grid(padding=(0, 2))
    for name, text in rows:
        grid.add_row(Text(name, style="bold"), text)
    return grid
