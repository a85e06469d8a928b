"""The command line: parses, calls one function, prints."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress

from railgate import doctor as checkup
from railgate import quantity
from railgate.odometer import plant
from railgate.odometer.measure import Measurement, measure, part
from railgate.odometer.simulate import simulate
from railgate.odometer.table import show
from railgate.options import Setup, with_setup
from railgate.waves import read

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


def _present(measured: Measurement, setup: Setup) -> None:
    paths = []
    if setup.out:
        from railgate.odometer.record import record  # matplotlib doubles the time to start

        paths = record(measured, setup.out)
    if setup.json:
        print(json.dumps(measured.as_json(), ensure_ascii=False, allow_nan=False, indent=1))
        return
    console = Console()
    if not console.is_terminal:
        console = Console(width=max(console.width, WIDTH))
    console.print(show(measured))
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
