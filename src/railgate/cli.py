"""The command line: parses, calls one function, prints."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console, RenderableType
from rich.progress import Progress

from railgate import doctor as checkup
from railgate import quantity
from railgate.odometer import plant
from railgate.odometer.measure import Measurement, measure, part
from railgate.odometer.simulate import simulate
from railgate.odometer.table import show
from railgate.options import Setup, with_setup
from railgate.waves import read

if TYPE_CHECKING:
    from railgate.proving.result import Result

__all__ = ["main"]

WIDTH = 110
"""Columns of a table that is not printed to a terminal."""

app = typer.Typer(no_args_is_help=True, add_completion=False)
simulations = typer.Typer(no_args_is_help=True)
app.add_typer(simulations, name="simulate", help="Run a function against its simulated plant.")


@app.callback()
def _railgate() -> None:
    """On-board train functions as open, proven gateware, and a workbench for them."""


@app.command("measure")
@with_setup
def measure_(
    capture: Annotated[Path, typer.Argument(help="A .sr, .vcd, .fst, .csv or .parquet file.")],
    a: Annotated[str, typer.Option(help="The channel that is A.")],
    b: Annotated[str, typer.Option(help="The channel that is B.")],
    window: Annotated[
        str | None, typer.Option(help="Only this part of the capture, as 0.5s..600ms.")
    ] = None,
    *,
    setup: Setup,
) -> None:
    """Speed, direction and distance from a capture of a two-channel wheel sensor."""
    pins = read(capture, [a, b]).rename({a: "a", b: "b"})
    if window is not None:
        pins = part(pins, quantity.span_s(window))
    with _progress(setup) as progress:
        measured = measure(pins, setup.config(), **setup.how(progress))
    _present(measured, setup)


@simulations.command("odometer")
@with_setup
def simulate_odometer(
    profile: Annotated[
        str, typer.Option(help=f"{', '.join(plant.PROFILES)}, or a CSV of time_s,speed_kmh.")
    ] = "run",
    seconds: Annotated[float, typer.Option(help="Length of a built-in profile, s.")] = 160.0,
    speed: Annotated[float, typer.Option(help="Speed of a built-in profile, km/h.")] = 200.0,
    duty: Annotated[float, typer.Option(help="High part of a pitch.")] = 0.5,
    phase: Annotated[float, typer.Option(help="How far B lags A forward, degrees.")] = 90.0,
    tooth: Annotated[float, typer.Option(help="Greatest true error of an edge, pitches.")] = 0.0,
    jitter: Annotated[str, typer.Option(help="Greatest delay of an edge.")] = "0s",
    dropouts: Annotated[float, typer.Option(help="Part of each channel's pulses lost.")] = 0.0,
    glitches: Annotated[str, typer.Option(help="Rate of stray pulses.")] = "0Hz",
    glitch: Annotated[str, typer.Option(help="Length of a stray pulse.")] = "1us",
    dead_a: Annotated[str | None, typer.Option(help="When A goes dead.")] = None,
    dead_b: Annotated[str | None, typer.Option(help="When B goes dead.")] = None,
    seed: Annotated[int, typer.Option(help="Of all that is random.")] = 0,
    *,
    setup: Setup,
) -> None:
    """A simulated train's wheel sensor through the odometer, with the true speed beside it."""
    sensor = plant.Sensor(
        duty=duty,
        phase_deg=phase,
        tooth_error=tooth,
        jitter_s=float(quantity.time_s(jitter)),
        dropouts=dropouts,
        glitches_hz=float(quantity.frequency_hz(glitches)),
        glitch_s=float(quantity.time_s(glitch)),
        a_dead_s=float("inf") if dead_a is None else float(quantity.time_s(dead_a)),
        b_dead_s=float("inf") if dead_b is None else float(quantity.time_s(dead_b)),
        seed=seed,
    )
    course = plant.course(profile, speed, seconds)
    with _progress(setup) as progress:
        measured = simulate(course, sensor, setup.config(), **setup.how(progress))
    if course.acceleration_m_s2 > setup.acceleration_max:
        print(
            f"railgate: the run accelerates at up to {course.acceleration_m_s2:.2f} m/s², above "
            f"the {setup.acceleration_max:g} m/s² assumed (--acceleration-max)",
            file=sys.stderr,
        )
    _present(measured, setup)


@app.command("prove")
def prove_(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="NAME", help="Claims, or how they begin.")
    ] = None,
    mutants: Annotated[
        bool, typer.Option("--mutants", help="Try that each broken variant is rejected too.")
    ] = False,
    fast: Annotated[
        bool, typer.Option("--fast", help="Only the claims that take less than 20 s each.")
    ] = False,
    solver: Annotated[str, typer.Option(help="yices, z3: who answers.")] = "yices",
    timeout: Annotated[str, typer.Option(help="The longest time for one answer.")] = "900s",
    jobs: Annotated[
        int, typer.Option(min=1, help="Claims at a time.", show_default="one a core")
    ] = os.cpu_count() or 1,
    replay: Annotated[
        Path | None, typer.Option(help="Only run the claim's gateware, in pysim, driven by a file.")
    ] = None,
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON array and nothing else.")
    ] = False,
    out: Annotated[Path, typer.Option(help="Write counterexamples there.")] = Path("build/prove"),
) -> None:
    """Prove what is claimed of the gateware; exit code 1 where a claim fails."""
    # Here, since no other command needs the solvers' side.
    from railgate.evidence.claims import chosen
    from railgate.proving.counterexample import replay as run_again
    from railgate.proving.prover import prove
    from railgate.proving.table import record
    from railgate.proving.tools import Tools

    claims = [claim for claim in chosen(names or ()) if claim.fast or not fast]
    if not claims:
        raise ValueError("--fast leaves no claim to prove")
    if replay is not None:
        if len(claims) != 1:
            raise ValueError(f"--replay needs one claim, not {len(claims)}")
        fall = run_again(claims[0], replay)
        print(f"{claims[0].name}: {fall or 'holds throughout'}")
        raise typer.Exit(int(fall is not None))
    tools = Tools(solver, float(quantity.time_s(timeout)))
    with _counted("proving", len(claims)) as done:
        results = prove(claims, tools, mutants=mutants, jobs=jobs, done=lambda _: done())
    _proofs(results, [record(result, out) for result in results], json)
    raise typer.Exit(int(any(result.failed for result in results)))


@app.command()
def doctor() -> None:
    """What is installed, which engines can run, what is missing and how to get it."""
    raise typer.Exit(checkup.examine(Console()))


@contextmanager
def _progress(setup: Setup) -> Iterator[Callable[[float], None] | None]:
    """A bar on the terminal for the engines that take long."""
    console = Console(stderr=True)
    if setup.engine == "leap" or not console.is_terminal:
        yield None
        return
    with Progress(console=console, transient=True) as bar:
        task = bar.add_task(f"{setup.engine} runs", total=1.0)
        yield lambda done: bar.update(task, completed=done)


@contextmanager
def _counted(what: str, total: int) -> Iterator[Callable[[], None]]:
    """A bar on the terminal that moves on with each call."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda: None
        return
    with Progress(console=console, transient=True) as bar:
        task = bar.add_task(what, total=total)
        yield lambda: bar.advance(task)


def _present(measured: Measurement, setup: Setup) -> None:
    paths = []
    if setup.out:
        from railgate.odometer.record import record  # matplotlib doubles the time to start

        paths = record(measured, setup.out)
    if setup.json:
        print(json.dumps(measured.as_json(), ensure_ascii=False, allow_nan=False, indent=1))
        return
    _print(show(measured), paths)


def _proofs(results: Sequence[Result], files: Sequence[list[Path]], as_json: bool) -> None:
    from railgate.proving.table import show

    if as_json:
        told = [
            result.as_json() | {"files": [str(path) for path in written]}
            for result, written in zip(results, files, strict=True)
        ]
        print(json.dumps(told, ensure_ascii=False, indent=1))
    else:
        _print(show(results), [path for written in files for path in written])


def _print(shown: RenderableType, paths: list[Path]) -> None:
    """A table, and the files that were written."""
    console = Console()
    if not console.is_terminal:
        console = Console(width=max(console.width, WIDTH))
    console.print(shown)
    for path in paths:
        console.print(f"wrote {path}", soft_wrap=True)


def main() -> None:
    """Run the command line; every error a user can provoke is one line and exit code 2."""
    try:
        sys.exit(app(standalone_mode=False) or 0)
    except typer.BadParameter as error:
        _fail(error.format_message())
    except (typer.TyperException, ValueError) as error:
        _fail(str(error))
    except (KeyboardInterrupt, typer.Abort):
        print("railgate: interrupted", file=sys.stderr)
        sys.exit(130)


def _fail(message: str) -> None:
    if message:  # empty after the help that stands for a missing command
        print(f"railgate: {' '.join(message.split())}", file=sys.stderr)
    sys.exit(2)
