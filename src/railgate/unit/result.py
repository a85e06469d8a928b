"""A run and what it comes to: what a person, a file and a program are told of it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railgate.position_link.host import summary
from railgate.unit.conditions import broken
from railgate.unit.events import Event, events
from railgate.unit.excerpts import Excerpts, excerpts
from railgate.unit.findings import Injected, injected
from railgate.unit.run import Run
from railgate.unit.verdict import Verdict, judge
from railgate.unit.window import Replayed

__all__ = ["Result"]


@dataclass(frozen=True, eq=False)
class Result:
    """name: of the scenario, as it was called. text: its TOML. run: what came of it. windows: of
    each function a part of it, run again in RTL."""

    name: str
    text: str
    run: Run
    windows: tuple[Replayed, ...] = ()

    @cached_property
    def events(self) -> list[Event]:
        """All that happened, in order of time."""
        return events(self.run)

    @cached_property
    def excerpts(self) -> Excerpts:
        """The spans of which waves are kept, and that of each event."""
        times = [event.time_s for event in self.events]
        return excerpts(times, self.run.scenario.seconds)

    @cached_property
    def verdict(self) -> Verdict:
        """Whether it was safe."""
        return judge(self.run)

    @cached_property
    def injected(self) -> tuple[Injected, ...]:
        """The faults, and how each was found."""
        return injected(self.run.scenario, self.events)

    @cached_property
    def outside(self) -> NDArray[np.bool_]:
        """In which cycles the true speed is outside the interval of FPGA 1's, FPGA 2's odometer.
        Shape (n, 2)."""
        cycles = self.run.cycles
        true = cycles.speed_kmh[:, None]
        found: NDArray[np.bool_] = (true < cycles.low_kmh) | (true > cycles.high_kmh)
        return found

    @property
    def speed_interval_violations(self) -> int:
        """Cycles in which the true speed is outside the interval of either odometer."""
        return int(self.outside.any(axis=1).sum())

    @property
    def distance_interval_violations(self) -> int:
        """Cycles in which the true way is outside the interval of either odometer."""
        cycles, start = self.run.cycles, self.run.scenario.route.start_m
        true = (cycles.place_m - start)[:, None]
        outside = (true < cycles.way_low_m) | (true > cycles.way_high_m)
        return int(outside.any(axis=1).sum())

    @property
    def distance_error_m(self) -> float:
        """Of FPGA 1's odometer, at the end."""
        cycles, start = self.run.cycles, self.run.scenario.route.start_m
        return float(cycles.way_m[-1, 0] - (cycles.place_m[-1] - start))

    def as_json(self) -> dict[str, Any]:
        """All but cycles and waves, as plain numbers, strings and lists; see docs/commands.md."""
        run, scenario, verdict = self.run, self.run.scenario, self.verdict
        worst = run.vital.verdict.worst_s("failure")
        return {
            "scenario": self.name,
            "title": scenario.name,
            "unit": scenario.unit,
            "engine": run.engine,
            "seed": scenario.seed,
            "seconds": float(scenario.seconds),
            "distance_m": float(run.cycles.place_m[-1] - scenario.route.start_m),
            "real_time_factor": run.real_time_factor,
            "spent_s": run.spent_s,
            "safe": verdict.safe,
            "reasons": list(verdict.reasons),
            "declared_reaction_s": float(verdict.declared_s),
            "worst_reaction_s": None if worst is None else float(worst),
            "distance_error_m": self.distance_error_m,
            "distance_interval_violations": self.distance_interval_violations,
            "speed_interval_violations": self.speed_interval_violations,
            "premises_broken": list(broken(scenario)),
            "link_availability": summary(run.link.told).availability,
            "windows": [{**vars(each), "warm_s": float(each.warm_s)} for each in self.windows],
            "faults": [_fault(each) for each in self.injected],
            "events": [
                {**vars(event), "waves": None if span is None else Excerpts.name(span)}
                for event, span in zip(self.events, self.excerpts.of, strict=True)
            ],
        }


def _fault(each: Injected) -> dict[str, Any]:
    return {**vars(each), "found": [vars(finding) for finding in each.found]}
