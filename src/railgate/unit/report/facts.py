"""What the report says in figures, and where they come from."""

from __future__ import annotations

import platform
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib.metadata import version

from railgate.odometer.host import Train
from railgate.position_link.host import summary
from railgate.unit.findings import Injected
from railgate.unit.result import Result
from railgate.unit.route import Side
from railgate.unit.run import Run
from railgate.vital_output.plant.edges import FEMTOSECOND

__all__ = ["Figure", "Visit", "facts", "figures", "visits"]

PACKAGES = ("railgate", "amaranth", "numpy", "numba")
REACTION = (
    "no single fault in one channel keeps a contact closed longer after the last agreed, live 1",
    "it is the life of a command by a clock that is slow by its whole tolerance, the decision, the "
    "longest right period of the pulses, and the relay's release",
    "two dynamic stages in series, each fed by one FPGA alone, pass current only while pulses of "
    "the right frequency come",
    "the relay opens within its release time when its coil has no current",
    "the CPUs agree on their inputs, and a fault of one does not make the other command a 1",
    "no fault invents a valid CRC",
)
"""What the declared reaction time is of and rests on: docs/vital_output.md in short."""


@dataclass(frozen=True)
class Figure:
    """tone: a colour of the page where the value is good or bad, else empty."""

    name: str
    value: str
    note: str
    tone: str = ""


@dataclass(frozen=True)
class Visit:
    """A call at a platform, and when its doors' contact was closed meanwhile."""

    at_m: float
    side: str
    arrives_s: float
    departs_s: float
    released: Sequence[tuple[float, float]]


def figures(result: Result) -> Iterator[Figure]:
    """The key figures of a run."""
    run, scenario = result.run, result.run.scenario
    cycles, seconds = run.cycles, float(scenario.seconds)
    way = cycles.place_m[-1] - scenario.route.start_m
    yield Figure(
        "run", f"{seconds:.1f} s", f"{way:,.0f} m, up to {cycles.speed_kmh.max():.0f} km/h"
    )
    yield _reaction(run)
    outside = result.speed_interval_violations
    yield Figure(
        "true speed outside its interval",
        f"{outside} cycle{'s' * (outside != 1)}",
        f"of {cycles.times_s.size}, by either odometer",
        "amber" if outside else "green",
    )
    yield _distance(result)
    told = summary(run.link.told)
    faulty = sum(told.causes.values())
    yield Figure(
        "position word there",
        f"{100 * told.availability:.2f} %",
        f"of {told.deliveries} cycles; {faulty or 'no'} fault{'s' * (faulty != 1)} seen",
    )
    if result.injected:
        yield _found(result.injected)
    yield Figure("events", str(len(result.events)), "each with speed and place")
    yield Figure(
        "against real time",
        f"{run.real_time_factor:.0f} ×",
        f"{sum(run.spent_s.values()):.1f} s on engine {run.engine}",
    )


def _distance(result: Result) -> Figure:
    cycles, outside = result.run.cycles, result.distance_interval_violations
    ends = (cycles.way_low_m, cycles.way_high_m)
    low, high = (column[-1, 0] - cycles.way_m[-1, 0] for column in ends)
    return Figure(
        "distance at the end",
        _metres(result.distance_error_m),
        f"guaranteed to {low:+.1f} … {high:+.1f} m; true one outside in {outside or 'no'} "
        f"cycle{'s' * (outside != 1)}",
        "amber" if outside else "",
    )


def _metres(metres: float) -> str:
    """As `+3.2 mm`, `-132.46 m`."""
    return f"{metres * 1e3:+.1f} mm" if abs(metres) < 1 else f"{metres:+.2f} m"


def _reaction(run: Run) -> Figure:
    verdict = run.vital.verdict
    declared = f"declared {float(verdict.declared_s) * 1e3:.1f} ms"
    failure, command = verdict.worst_s("failure"), verdict.worst_s("command")
    worst = command if failure is None else failure
    tone = "red" if verdict.violations else ""
    if worst is None:
        return Figure("reaction", "not seen", f"no contact opened; {declared}")
    why = "by command" if failure is None else "by a failure"
    return Figure("slowest reaction", f"{float(worst) * 1e3:.1f} ms", f"{why}; {declared}", tone)


def _found(injected: Sequence[Injected]) -> Figure:
    found = sum(bool(each.found) for each in injected)
    count = len(injected)
    return Figure(
        "faults found",
        f"{found} of {count}",
        "told by the unit",
        "green" if found == count else "amber",
    )


def visits(run: Run) -> list[Visit]:
    """All calls, in order."""
    found = []
    for call in run.scenario.route.calls:
        stop = call.stop
        released = [
            (float(each.closed * FEMTOSECOND), float(each.opened * FEMTOSECOND))
            for each in run.vital.verdict.closings
            if Side(each.output) is stop.side
        ]
        here = [span for span in released if span[0] < call.departs_s and span[1] > call.arrives_s]
        side = stop.side.name.lower()
        found.append(Visit(stop.at_m, side, call.arrives_s, call.departs_s, here))
    return found


def facts(result: Result) -> Iterator[tuple[str, str | Sequence[str]]]:
    """What the run was made with and of."""
    run, scenario = result.run, result.run.scenario
    unit = scenario.config
    yield "scenario", f"{result.name}, for the unit “{scenario.unit}”"
    yield "seed", str(scenario.seed)
    yield "engine", f"{run.engine}: " + ", ".join(f"{k} {v:.2f} s" for k, v in run.spent_s.items())
    yield (
        "versions",
        ", ".join(
            [
                f"Python {platform.python_version()}",
                *(f"{name} {version(name)}" for name in PACKAGES),
            ]
        ),
    )
    yield (
        "clocks",
        f"FPGA 1 {float(scenario.ppm_1):+g} ppm, FPGA 2 {float(scenario.ppm_2):+g} ppm, "
        f"±{unit.vital.tolerance_ppm} tolerated",
    )
    yield (
        "configurations",
        f"odometer {unit.odometer.digest:#010x}, position link {unit.link.digest:#010x}, "
        f"vital output {unit.vital.digest:#010x}",
    )
    train = Train(unit.odometer, unit.assumptions, unit.wheels, unit.rolling)
    yield "speed and distance rest on", train.rests_on
    yield "declared reaction", (f"{float(unit.vital.reaction_s) * 1e3:.2f} ms", *REACTION)
    yield "charts", "uPlot 1.6.32, MIT licence"
