"""The odometer's commands."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from railgate import quantity
from railgate.cli.options import finite, option, whole_hz, with_setup
from railgate.cli.output import present, running
from railgate.engines import ENGINES
from railgate.odometer import plant
from railgate.odometer.host import ESTIMATORS
from railgate.odometer.measure import How, Measurement, Progress, measure, part
from railgate.odometer.simulate import simulate
from railgate.odometer.spec import Assumptions, Config
from railgate.odometer.table import show
from railgate.waves import read

__all__ = ["Setup", "measure_", "simulate_odometer"]


@dataclass(frozen=True)
class Setup:
    """The odometer, the engine, the estimator and where the result goes, as the user gave them."""

    clock: Annotated[str, option("Reference clock.")] = "16MHz"
    pulses_per_rev: Annotated[int, option("Pulses per wheel revolution and channel.")] = 200
    wheel_diameter: Annotated[str, option("Wheel diameter.")] = "650mm"
    every: Annotated[str, option("Time between two reads by the CPU.")] = "20ms"
    filter: Annotated[int, option("Glitch filter: levels of at most so many ticks vanish.")] = 0
    overspeed_kmh: Annotated[float, option("Overspeed is flagged above this.")] = 220.0
    engine: Annotated[
        str, option(f"{', '.join(ENGINES)}: leap is the model, the others the gateware.")
    ] = "leap"
    estimator: Annotated[str, option(f"{', '.join(ESTIMATORS)}: how speed is made.")] = "pi"
    crystal_ppm: Annotated[float, option("Assumed: the clock's tolerance, ppm.")] = 100.0
    diameter_tolerance: Annotated[str, option("Assumed: the wheel's tolerance.")] = "0mm"
    tooth_error: Annotated[float, option("Assumed: an edge's greatest error, pitches.")] = 0.0
    acceleration_max: Annotated[float, option("Assumed: greatest acceleration, m/s².")] = 1.5
    jerk_max: Annotated[float, option("Assumed: greatest jerk, m/s³, for feasible.")] = 0.0
    json: Annotated[bool, option("Print one JSON object and nothing else.", "--json")] = False
    out: Annotated[Path | None, option("Write tables, waves and a picture there.")] = None

    def config(self) -> Config:
        """The odometer's configuration, of one sensor. Raises ValueError."""
        return Config(
            clock_hz=whole_hz("--clock", self.clock),
            sensors=1,
            pulses_per_rev=self.pulses_per_rev,
            wheel_diameter_m=quantity.length_m(self.wheel_diameter),
            filter_ticks=self.filter,
            overspeed_kmh=finite("--overspeed-kmh", self.overspeed_kmh),
        )

    def how(self, progress: Progress | None) -> How:
        """How to measure. Raises ValueError."""
        assumptions = Assumptions(
            crystal_ppm=self.crystal_ppm,
            diameter_tolerance_m=float(quantity.length_m(self.diameter_tolerance)),
            tooth_error=self.tooth_error,
            acceleration_max=self.acceleration_max,
            jerk_max=self.jerk_max,
        )
        return How(
            every_s=quantity.time_s(self.every),
            engine=self.engine,
            estimator=self.estimator,
            assumptions=assumptions,
            progress=progress,
        )


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
    with running(setup.engine) as progress:
        measured = measure(pins, setup.config(), **setup.how(progress))
    _present(measured, setup)


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
    with running(setup.engine) as progress:
        measured = simulate(course, sensor, setup.config(), **setup.how(progress))
    if course.acceleration_m_s2 > setup.acceleration_max:
        print(
            f"railgate: the run accelerates at up to {course.acceleration_m_s2:.2f} m/s², above "
            f"the {setup.acceleration_max:g} m/s² assumed (--acceleration-max)",
            file=sys.stderr,
        )
    _present(measured, setup)


def _present(measured: Measurement, setup: Setup) -> None:
    paths = []
    if setup.out:
        from railgate.odometer.record import record  # matplotlib doubles the time to start

        paths = record(measured, setup.out)
    present(measured.as_json() if setup.json else show(measured), paths)
