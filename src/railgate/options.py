"""The options that the odometer's commands share, declared once."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable
from dataclasses import dataclass, fields
from fractions import Fraction
from pathlib import Path
from typing import Annotated, Any, get_type_hints

import typer

from railgate import quantity
from railgate.engines import ENGINES
from railgate.odometer.host import ESTIMATORS
from railgate.odometer.measure import How, Progress
from railgate.odometer.spec import Assumptions, Config

__all__ = ["Setup", "with_setup"]


def _option(help: str, *names: str) -> Any:
    return typer.Option(*names, help=help)


def _finite(name: str, value: float) -> Fraction:
    if not math.isfinite(value):
        raise ValueError(f"{name} must be a finite number, not {value}")
    return Fraction(str(value))


@dataclass(frozen=True)
class Setup:
    """The odometer, the engine, the estimator and where the result goes, as the user gave them."""

    clock: Annotated[str, _option("Reference clock.")] = "16MHz"
    pulses_per_rev: Annotated[int, _option("Pulses per wheel revolution and channel.")] = 200
    wheel_diameter: Annotated[str, _option("Wheel diameter.")] = "650mm"
    every: Annotated[str, _option("Time between two reads by the CPU.")] = "20ms"
    filter: Annotated[int, _option("Glitch filter: levels of at most so many ticks vanish.")] = 0
    overspeed_kmh: Annotated[float, _option("Overspeed is flagged above this.")] = 220.0
    engine: Annotated[
        str, _option(f"{', '.join(ENGINES)}: leap is the model, the others the gateware.")
    ] = "leap"
    estimator: Annotated[str, _option(f"{', '.join(ESTIMATORS)}: how speed is made.")] = "pi"
    crystal_ppm: Annotated[float, _option("Assumed: the clock's tolerance, ppm.")] = 100.0
    diameter_tolerance: Annotated[str, _option("Assumed: the wheel's tolerance.")] = "0mm"
    tooth_error: Annotated[float, _option("Assumed: an edge's greatest error, pitches.")] = 0.0
    acceleration_max: Annotated[float, _option("Assumed: greatest acceleration, m/s².")] = 1.5
    jerk_max: Annotated[float, _option("Assumed: greatest jerk, m/s³, for feasible.")] = 0.0
    json: Annotated[bool, _option("Print one JSON object and nothing else.", "--json")] = False
    out: Annotated[Path | None, _option("Write tables, waves and a picture there.")] = None

    def config(self) -> Config:
        """The odometer's configuration, of one sensor. Raises ValueError."""
        clock_hz = quantity.frequency_hz(self.clock)
        if clock_hz.denominator != 1:
            raise ValueError(f"--clock must be a whole number of Hz, not {self.clock}")
        return Config(
            clock_hz=int(clock_hz),
            sensors=1,
            pulses_per_rev=self.pulses_per_rev,
            wheel_diameter_m=quantity.length_m(self.wheel_diameter),
            filter_ticks=self.filter,
            overspeed_kmh=_finite("--overspeed-kmh", self.overspeed_kmh),
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


def with_setup(command: Callable[..., None]) -> Callable[..., None]:
    """A command whose last parameter, `setup`, is spread into the options of Setup."""
    hints = get_type_hints(command, include_extras=True)
    shared = get_type_hints(Setup, include_extras=True)
    own = [
        parameter.replace(annotation=hints[parameter.name])
        for parameter in inspect.signature(command).parameters.values()
        if parameter.name != "setup"
    ]
    spread = [
        inspect.Parameter(
            field.name,
            inspect.Parameter.KEYWORD_ONLY,
            default=field.default,
            annotation=shared[field.name],
        )
        for field in fields(Setup)
    ]

    def spread_out(**given: Any) -> None:
        setup = Setup(**{field.name: given.pop(field.name) for field in fields(Setup)})
        command(**given, setup=setup)

    parameters = [p.replace(kind=inspect.Parameter.KEYWORD_ONLY) for p in own] + spread
    spread_out.__name__, spread_out.__doc__ = command.__name__, command.__doc__
    spread_out.__annotations__ = {p.name: p.annotation for p in parameters}
    spread_out.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    return spread_out
