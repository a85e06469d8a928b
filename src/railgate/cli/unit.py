"""The commands for runs of the whole on-board unit."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import resources
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from railgate.cli.output import present
from railgate.engines import ENGINES
from railgate.quantity import span_s
from railgate.unit.run import STAGES, run
from railgate.unit.scenario import Scenario
from railgate.unit.scenario_file import builtin, builtins, read_scenario

__all__ = ["run_", "scenarios_"]

OUT = Path("build/run")


def run_(
    scenario: Annotated[
        str, typer.Argument(help=f"{', '.join(builtins())}, or a TOML file.")
    ] = "metro",
    engine: Annotated[
        str, typer.Option(help=f"{', '.join(ENGINES)}: leap is the model, the others the gateware.")
    ] = "leap",
    window: Annotated[
        str | None,
        typer.Option(help="T0..T1: run on leap, and this part of it on ENGINE too; compare both."),
    ] = None,
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object and nothing else.")
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(help="Write the report and its files there; None: build/run/NAME."),
    ] = None,
) -> None:
    """A train's run through the whole unit: what happened, whether it was safe, and a report."""
    # Here, since no other command needs the report.
    from railgate.unit.record import record
    from railgate.unit.result import Result
    from railgate.unit.table import show
    from railgate.unit.window import replay, replayable

    name, text, chosen = _chosen(scenario)
    span = None if window is None else replayable(chosen, span_s(window), engine)
    with _staged((*STAGES, "report and files")) as begin:
        ran = run(chosen, engine if span is None else "leap", begin)
        windows = () if span is None else tuple(replay(ran, span, engine, begin))
        begin("report and files")
        result = Result(name, text, ran, windows)
        paths = record(result, out or OUT / name)
    present(result.as_json() if json else show(result), paths[:1])
    differs = any(each.difference is not None for each in windows)
    raise typer.Exit(int(differs or not result.verdict.safe))


def scenarios_(
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON array and nothing else.")
    ] = False,
) -> None:
    """The scenarios that are built in."""
    from railgate.unit.table import show_scenarios

    each = {name: builtin(name) for name in builtins()}
    present(
        [_told(name, scenario) for name, scenario in each.items()]
        if json
        else show_scenarios(each.items()),
        [],
    )


def _told(name: str, scenario: Scenario) -> dict[str, object]:
    stops = scenario.route.stops
    return {
        "scenario": name,
        "title": scenario.name,
        "unit": scenario.unit,
        "seed": scenario.seed,
        "seconds": float(scenario.seconds),
        "distance_m": stops[-1].at_m - stops[0].at_m,
        "stops": len(stops),
        "faults": [f"{fault.part}: {fault.kind}" for fault in scenario.faults],
    }


def _chosen(name: str) -> tuple[str, str, Scenario]:
    """A scenario's short name, its text, and the scenario. Raises ValueError."""
    path = Path(name)
    if name not in builtins() and path.exists():
        scenario = read_scenario(path)
        return path.stem, path.read_text("utf-8"), scenario
    scenario = builtin(name)
    file = resources.files("railgate.unit").joinpath("scenarios", f"{name}.toml")
    return name, file.read_text("utf-8"), scenario


@contextmanager
def _staged(stages: tuple[str, ...]) -> Iterator[Callable[[str], None]]:
    """A bar on the terminal that names the stage under way; it is told of each that begins. One
    that is not of `stages` is only named."""
    console = Console(stderr=True)
    columns = (SpinnerColumn(), TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Progress(
        *columns, console=console, transient=True, disable=not console.is_terminal
    ) as bar:
        task = bar.add_task("scenario", total=len(stages))

        def begin(stage: str) -> None:
            done = stages.index(stage) if stage in stages else None
            bar.update(task, description=stage, completed=done)

        yield begin
