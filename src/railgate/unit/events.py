"""What happened in a run, on one time base, each event with measured speed and place (SYS-6)."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from railgate.odometer.host import Verdict
from railgate.odometer.spec import Flag
from railgate.position_link.host import Deliveries
from railgate.position_link.spec import Health, cause_names
from railgate.unit.faults import FAULTS
from railgate.unit.run import Run

__all__ = ["Event", "events"]

ROUTINE = re.compile(r"frame \d+, image \w+, accepted|vote passed|stored: .*")
"""What every cycle has in which all is well."""
NUMBERS = re.compile(r"\d+")
PAUSE_CYCLES = 2.5
"""An event like the last one, no later than so many cycles after it, is the same thing going on."""


@dataclass(frozen=True)
class Event:
    """time_s: since the run's start. source: the part of the unit, or `train`, `fault`, `CPUs`,
    `relay`. speed_kmh: by FPGA 1's odometer, place_m: the place by the position word or,
    without one, by the odometer; both of the system cycle before, None in the first."""

    time_s: float
    source: str
    what: str
    speed_kmh: float | None
    place_m: float | None


def events(run: Run) -> list[Event]:
    """All of a run, in order of time; what goes on in cycle after cycle is told once."""
    told = [
        *_train(run),
        *_faults(run),
        *(each for fpga in (1, 2) for each in _odometer(run, fpga)),
        *_link(run.link.told, run.link.times_s.tolist()),
        *_vital(run),
    ]
    told.sort(key=lambda each: each[0])
    pause_s = PAUSE_CYCLES * float(run.scenario.config.vital.cycle_s)
    return [_measured(run, *each) for each in _begun(told, pause_s)]


Told = tuple[float, str, str]
"""When, of what, and what."""


def _begun(told: Iterable[Told], pause_s: float) -> Iterator[Told]:
    """Without those like the last of their source and kind that came not long before."""
    last: dict[tuple[str, str], float] = {}
    for time_s, source, what in told:
        kind = source, NUMBERS.sub("", what)
        before = last.get(kind)
        last[kind] = time_s
        lasting = what.startswith(("vote", "message", "frame", "clock"))
        if not lasting or before is None or time_s - before > pause_s:
            yield time_s, source, what


def _measured(run: Run, time_s: float, source: str, what: str) -> Event:
    cycles = run.cycles
    n = int(np.searchsorted(cycles.times_s, time_s, side="right")) - 1
    if n < 0:
        return Event(time_s, source, what, None, None)
    word, way = float(cycles.word_m[n]), float(cycles.way_m[n, 0])
    speed = float(cycles.measured_kmh[n, 0])
    place = run.scenario.route.start_m + way if np.isnan(word) else word
    return Event(time_s, source, what, speed if np.isfinite(speed) else None, place)


def _train(run: Run) -> Iterator[Told]:
    for call in run.scenario.route.calls:
        at = f"the platform at {call.stop.at_m:g} m"
        if call.arrives_s:
            yield call.arrives_s, "train", f"stops at {at}"
        if call.departs_s < float(run.scenario.seconds):
            yield call.departs_s, "train", f"leaves {at}"


def _faults(run: Run) -> Iterator[Told]:
    for fault in run.scenario.faults:
        if fault.part == "vital":
            continue  # the vital output's own timeline has them
        of = f"axle {fault.axle} " if fault.part == "wheel" else "position link "
        name, does = f"{of}{fault.kind}", FAULTS[fault.part][fault.kind].partition("; value")[0]
        yield float(fault.start_s), "fault", f"{name}: {does}"
        if fault.end_s is not None and fault.end_s < run.scenario.seconds:
            yield float(fault.end_s), "fault", f"{name} ends"


def _odometer(run: Run, fpga: int) -> Iterator[Told]:
    """Flags that rise, axles that slip, slide or are lost, and standstill."""
    source, cycles = f"odometer {fpga}", run.cycles
    times = cycles.times_s.tolist()
    stands = cycles.stands[:, fpga - 1].tolist()
    for (_, before), (time_s, stands_now) in pairwise(zip(times, stands, strict=True)):
        if stands_now != before:
            yield time_s, source, "standstill" if stands_now else "the train moves"
    verdicts = cycles.verdicts[:, fpga - 1]
    for n, axle in np.argwhere(np.diff(verdicts, axis=0)):
        now = Verdict(int(verdicts[n + 1, axle])).name.lower()
        yield times[n + 1], source, f"axle {axle + 1}: {now}"
    flags = run.odometers[fpga - 1].seen["flags"]
    rises = flags & ~np.concatenate([flags[:1] * 0, flags[:-1]])
    for n, axle in np.argwhere(rises):
        for flag in Flag:
            if flag & int(rises[n, axle]) and flag.name:
                name = flag.name.lower().replace("_", " ")
                yield times[n], source, f"axle {axle + 1}: {name}"


def _link(told: Deliveries, times_s: Sequence[float]) -> Iterator[Told]:
    health, causes = told.fields["health"].tolist(), told.fields["causes"].tolist()
    before = int(Health.START)
    for time_s, now, cause in zip(times_s, health, causes, strict=True):
        if now != before:
            why = ", ".join(cause_names(cause)).replace("_", " ")
            yield time_s, "position link", Health(now).name.lower() + (f": {why}" if why else "")
        before = now


def _vital(run: Run) -> Iterator[Told]:
    for event in run.vital.events:
        if not ROUTINE.fullmatch(event.what):
            yield event.time_s, event.source, event.what
