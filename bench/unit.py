"""An hour of the whole on-board unit on its models, against real time and against RTL."""

from __future__ import annotations

import resource
import time
from fractions import Fraction
from statistics import median

from rich.progress import track

from bench.row import Row, row
from railgate.engines import open_engine
from railgate.odometer.plant import Sensor
from railgate.unit.route import Route, Side, Stop
from railgate.unit.run import Run
from railgate.unit.run import run as run_unit
from railgate.unit.scenario import Scenario
from railgate.unit.window import cases

__all__ = ["run"]

ROUNDS = 5
HOUR_S = 3_600
STATION_M = 1_000
PIECE_S = Fraction(1, 50)
"""What RTL runs of it: what a tick costs there does not depend on what is in it."""
MOST_GIB = 2


def run() -> list[Row]:
    """Rows of name, value, unit, goal, met."""
    scenario = _hour()
    found = run_unit(scenario)  # compiled before any time counts
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1 << 20)
    rtl_s = _rtl_s(found) / float(PIECE_S)  # of a second of operation
    factors, ratios = [], []
    for _ in track(range(ROUNDS), "the unit, 1 h", transient=True):
        spent = sum(run_unit(scenario).spent_s.values())
        factors.append(float(scenario.seconds) / spent)
        ratios.append((_rtl_s(found) / float(PIECE_S)) * factors[-1])
    return [
        row("unit: 1 h on leap against real time", median(factors), "×", least=360),
        row("unit: 1 h on leap, memory at most", peak, "GiB", most=MOST_GIB),
        row("unit: leap / cxxrtl", median(ratios), "×"),
        row("unit: cxxrtl against real time", 1 / rtl_s, "×"),
    ]


def _hour() -> Scenario:
    """A metro that stops every kilometre, for an hour."""
    stops: list[Stop] = []
    while True:
        stops.append(Stop(at_m=STATION_M * len(stops), side=Side(len(stops) % 2), dwell_s=25))
        if len(stops) > 1:
            route = Route(stops=stops, speed_kmh=80)
            if route.calls[-1].departs_s >= HOUR_S:
                return Scenario(
                    name="an hour of metro",
                    route=route,
                    sensor=Sensor(tooth_error=0.02),
                    ppm_1=Fraction(60),
                    ppm_2=Fraction(-45),
                )


def _rtl_s(found: Run) -> float:
    """Seconds that RTL takes for the first part of the run, all functions one after the other."""
    spent = 0.0
    for case in cases(found, (Fraction(0), PIECE_S)):
        engine = open_engine(case.design, "cxxrtl")
        begin = time.perf_counter()
        engine.advance(case.stimulus.end, case.stimulus)
        spent += time.perf_counter() - begin
    return spent
