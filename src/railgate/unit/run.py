"""A whole run: sensors → speed and position → the CPUs' decision → frames → votes → relays."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from railgate.odometer.host import Train
from railgate.odometer.plant import Profile
from railgate.unit.application import Replica, View, decide
from railgate.unit.config import AXLES
from railgate.unit.faults import vital_faults
from railgate.unit.scenario import Scenario
from railgate.unit.sensing import Link, Odometer, link, odometer, wheels
from railgate.vital_output.plant import Command, Cpus
from railgate.vital_output.plant import Scenario as VitalScenario
from railgate.vital_output.simulate import Run as VitalRun
from railgate.vital_output.simulate import simulate

__all__ = ["STAGES", "Cycles", "Run", "run", "vital_scenario"]

STAGES = (
    "wheels and sensors",
    "odometer of FPGA 1",
    "odometer of FPGA 2",
    "position link",
    "both CPUs",
    "vital output",
)
FPGAS = (1, 2)
STILL = 7
"""The column of a row of Train.replay that tells of standstill."""
Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Cycles:
    """What was known in each system cycle but the first, column by column, each of shape (n,).

    times_s: when it began. speed_kmh, place_m: the truth. By FPGA 1's and FPGA 2's odometer, shape
    (n, 2): the train's speed and its interval, its way since the start and the interval of that,
    its standstill; and of each axle its verdict, shape (n, 2, axles), see odometer.host.Verdict.
    word_m: the position word's place, NaN where none was believed. status, age, health: of the
    delivery it came with. image: what both CPUs commanded.
    """

    times_s: Floats
    speed_kmh: Floats
    place_m: Floats
    measured_kmh: Floats
    low_kmh: Floats
    high_kmh: Floats
    way_m: Floats
    way_low_m: Floats
    way_high_m: Floats
    stands: NDArray[np.bool_]
    verdicts: NDArray[np.int64]
    word_m: Floats
    status: NDArray[np.int64]
    age: NDArray[np.int64]
    health: NDArray[np.int64]
    image: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Run:
    """A scenario's run on one engine. spent_s: what each stage took, by its name."""

    scenario: Scenario
    engine: str
    profile: Profile
    odometers: tuple[Odometer, Odometer]
    link: Link
    cycles: Cycles
    vital: VitalRun
    spent_s: dict[str, float]

    @property
    def real_time_factor(self) -> float:
        """Seconds of operation for one of computing."""
        return float(self.scenario.seconds) / sum(self.spent_s.values())


def run(
    scenario: Scenario, engine: str = "leap", progress: Callable[[str], None] | None = None
) -> Run:
    """Run a scenario to its end. progress: is told of each stage that begins. Raises ValueError."""
    spent: dict[str, float] = {}

    @contextmanager
    def stage(name: str) -> Iterator[None]:
        if progress:
            progress(name)
        begin = time.perf_counter()
        yield
        spent[name] = time.perf_counter() - begin

    profile, found = scenario.profile, []
    with stage(STAGES[0]):
        channels = wheels(scenario, profile)
    for fpga in FPGAS:
        with stage(STAGES[fpga]):
            found.append(odometer(scenario, fpga, channels, engine))
    with stage(STAGES[3]):
        position = link(scenario, profile, engine)
    with stage(STAGES[4]):
        cycles = _cycles(scenario, profile, found, position)
    with stage(STAGES[5]):
        vital = simulate(vital_scenario(scenario, cycles), scenario.config.vital, engine)
    return Run(scenario, engine, profile, (found[0], found[1]), position, cycles, vital, spent)


def _cycles(
    scenario: Scenario, profile: Profile, odometers: Sequence[Odometer], position: Link
) -> Cycles:
    """Both replicas through the run."""
    unit, calls = scenario.config, scenario.route.calls
    cycle_s = unit.vital.cycle_s
    times = np.arange(1, scenario.cycles, dtype=np.float64) * float(cycle_s)
    there = np.searchsorted(position.times_s, times, side="right") - 1
    words = position.told.values["position"]
    word = np.where(there >= 0, words.filled(np.nan)[np.maximum(there, 0)], np.nan)
    # Rows of speed, its bounds, way, its bounds, what was compensated, standstill, verdicts.
    told = np.stack([_told(scenario, each) for each in odometers], axis=1)
    stands = told[:, :, STILL] != 0
    alive = [_alive(scenario, fpga) for fpga in FPGAS]
    replicas = [Replica(scenario.rule, calls) for _ in FPGAS]
    image = np.zeros(times.size, np.int64)
    for n, (at, place) in enumerate(zip(times.tolist(), word.tolist(), strict=True)):
        known = None if np.isnan(place) else place
        views: list[View | None] = [
            replica.update(at, still, known) if lives[n] else None
            for replica, still, lives in zip(replicas, stands[n].tolist(), alive, strict=True)
        ]
        image[n] = decide(views)
    fields = {
        name: position.told.fields[name][np.maximum(there, 0)]
        for name in ("status", "age", "health")
    }
    return Cycles(
        times_s=times,
        speed_kmh=profile.speed_kmh(times),
        place_m=scenario.route.start_m + profile.position_m(times),
        measured_kmh=3.6 * told[:, :, 0],
        low_kmh=3.6 * told[:, :, 1],
        high_kmh=3.6 * told[:, :, 2],
        way_m=told[:, :, 3],
        way_low_m=told[:, :, 4],
        way_high_m=told[:, :, 5],
        stands=stands,
        verdicts=told[:, :, STILL + 1 : STILL + 1 + AXLES].astype(np.int64),
        word_m=word,
        image=image,
        **{name: column.astype(np.int64) for name, column in fields.items()},
    )


def _told(scenario: Scenario, odometer: Odometer) -> NDArray[np.float64]:
    """What a CPU makes of its odometer's snapshots: rows as of Train.replay."""
    unit = scenario.config
    train = Train(unit.odometer, unit.assumptions, unit.wheels, unit.rolling)
    return train.replay(odometer.seen)


def _alive(scenario: Scenario, cpu: int) -> NDArray[np.bool_]:
    """In which cycles this CPU works, but the first."""
    lives = np.ones(scenario.cycles - 1, np.bool_)
    cycle_s = scenario.config.vital.cycle_s
    for fault in scenario.faults:
        if (fault.part, fault.kind) == ("vital", f"cpu-{cpu}-dead"):
            last = scenario.seconds if fault.end_s is None else fault.end_s
            first = max(int(fault.start_s / cycle_s) - 1, 0)
            lives[first : -int(-last // cycle_s) - 1] = False
    return lives


def vital_scenario(scenario: Scenario, cycles: Cycles) -> VitalScenario:
    """The run of both channels in which the CPUs command what they have decided."""
    cycle_s = scenario.config.vital.cycle_s
    every = (1 << scenario.config.vital.outputs) - 1
    marks = {int(at / cycle_s) for at in scenario.acknowledged_s}
    commands: list[Command] = []
    for n, image in enumerate(cycles.image.tolist(), 1):
        acknowledge = every if n in marks else 0
        if not commands or (commands[-1].image, commands[-1].acknowledge) != (image, acknowledge):
            commands.append(Command(start_s=n * cycle_s, image=image, acknowledge=acknowledge))
    return VitalScenario(
        commands=tuple(commands),
        seconds=scenario.seconds,
        ppm_1=scenario.ppm_1,
        ppm_2=scenario.ppm_2,
        relay=scenario.relay,
        cpus=Cpus(skew_s=scenario.skew_s),
        faults=vital_faults(scenario.faults),
        seed=scenario.seed,
    )
