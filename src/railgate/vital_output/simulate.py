"""Both channels against simulated CPUs, time, cross-link and relays: a run and what came of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

from railgate.engines import Engine, open_engine
from railgate.engines.signals import parts
from railgate.vital_output.loop import loop
from railgate.vital_output.observed import Observed
from railgate.vital_output.plant.edges import FEMTOSECOND, femtoseconds
from railgate.vital_output.plant.scenario import Scenario
from railgate.vital_output.spec import CAUSES, Config
from railgate.vital_output.timeline import Event, timeline
from railgate.vital_output.verdict import Closing, Verdict, judge
from railgate.waves import Trace

__all__ = ["COUNTS", "Progress", "Run", "simulate"]

Progress = Callable[[float], None]
Span = tuple[Fraction, Fraction]
"""Seconds."""

STEPS = 100
"""So often progress is told."""
PINS = tuple(f"fpga_{fpga}.{name}" for fpga in (1, 2) for name in ("pulses", "link_tx"))
COUNTS = ("accepted", "start", "lost", "passed", "stored", *(c.name.lower() for c in CAUSES))


@dataclass(frozen=True)
class Run:
    """What two channels made of a scenario, in femtoseconds.

    trace: of the whole run all inputs, and all outputs but pulses and cross-link. waves: of the
    part that was asked for these too, else the same as trace.
    """

    engine: str
    config: Config
    scenario: Scenario
    trace: Trace
    waves: Trace

    @property
    def stimulus(self) -> Trace:
        """The inputs of the Loop alone."""
        told = set(_outputs(self.config))
        return self.trace.select(name for name in self.trace.signals if name not in told)

    @cached_property
    def channels(self) -> tuple[Observed, Observed]:
        """FPGA 1 and FPGA 2."""
        clock_1, clock_2, _ = self.scenario.clocks(self.config)
        return (
            Observed(self.config, clock_1, self.trace, 1),
            Observed(self.config, clock_2, self.trace, 2),
        )

    @cached_property
    def verdict(self) -> Verdict:
        """Whether the contacts opened in the declared time."""
        return judge(self.config, self.trace["contact"], self.trace.end, self.channels)

    @cached_property
    def events(self) -> list[Event]:
        """All that happened, in order of time."""
        return timeline(self.config, self.scenario, self.channels, self.verdict)

    def as_json(self) -> dict[str, Any]:
        """All but the waves, as plain numbers, strings and lists; see docs/commands.md."""
        config, verdict = self.config, self.verdict
        return {
            "engine": self.engine,
            "clock_hz": config.clock_hz,
            "outputs": config.outputs,
            "cycle_s": float(config.cycle_s),
            "duration_s": float(self.trace.duration_s),
            "declared_reaction_s": float(verdict.declared_s),
            "worst_reaction_s": _number(verdict.worst_s("failure")),
            "worst_commanded_s": _number(verdict.worst_s("command")),
            "safe": not verdict.violations,
            "closings": [self._closing(each) for each in verdict.closings],
            "fpga_1": {name: self.channels[0].total(name) for name in COUNTS},
            "fpga_2": {name: self.channels[1].total(name) for name in COUNTS},
            "events": [
                {"t_s": float(each.time_s), "source": each.source, "what": each.what}
                for each in self.events
            ],
        }

    def _closing(self, each: Closing) -> dict[str, Any]:
        """One span of a closed contact as plain numbers and strings."""
        return {
            "output": each.output,
            "closed_s": float(each.closed * FEMTOSECOND),
            "opened_s": None if each.lasts else float(each.opened * FEMTOSECOND),
            "opened_by": each.opened_by,
            "live_s": None if each.live is None else float(each.live * FEMTOSECOND),
            "since_live_s": _number(each.since_live_s),
            "safe": not self.verdict.too_long(each),
        }


def _number(value: Fraction | None) -> float | None:
    return None if value is None else float(value)


def simulate(
    scenario: Scenario,
    config: Config,
    engine: str = "leap",
    progress: Progress | None = None,
    waves_s: Span | None = None,
) -> Run:
    """Run a scenario to its end.

    waves_s: the part of the run of which pulses and cross-link are kept too. Raises ValueError.
    """
    stimulus = scenario.controls(config)
    start, stop = _ticks(waves_s, stimulus.end)
    opened = open_engine(loop(config, scenario.relay, scenario.clocks(config)), engine)
    told = _outputs(config)
    pieces, waves = list(_run(opened, start, stimulus, told, progress)), []
    for piece in _run(opened, stop, stimulus, [*told, *PINS], progress):
        pieces.append(piece.select(told))
        waves.append(piece)
    pieces += _run(opened, stimulus.end, stimulus, told, progress)
    trace = stimulus.merge(pieces[0].concatenate(*pieces[1:]))
    part = stimulus.slice(start, stop)
    return Run(
        engine=engine,
        config=config,
        scenario=scenario,
        trace=trace,
        waves=part.merge(waves[0].concatenate(*waves[1:])) if waves else trace,
    )


def _ticks(span: Span | None, end: int) -> tuple[int, int]:
    """The part that is kept with all, in femtoseconds; without one none, at the end."""
    if span is None:
        return end, end
    start, stop = (femtoseconds(time) for time in span)
    if not 0 <= start < end:
        raise ValueError(
            f"waves must begin inside the run of {float(end * FEMTOSECOND):g} s, "
            f"not at {float(span[0]):g} s"
        )
    return start, min(stop, end)


def _outputs(config: Config) -> list[str]:
    """The signals of a Loop that are kept of all of the run."""
    fields = [name for field in config.fields for name, *_ in parts(field.name, field.width)]
    return [
        "contact",
        *(f"fpga_{fpga}.{name}" for fpga in (1, 2) for name in ("command.ready", *fields)),
    ]


def _run(
    opened: Engine,
    until: int,
    stimulus: Trace,
    outputs: Sequence[str],
    progress: Progress | None,
) -> Iterator[Trace]:
    """Run to a tick with these outputs; in steps, where progress is told."""
    step = stimulus.end // STEPS + 1 if progress else stimulus.end
    while opened.now < until:
        yield opened.advance(min(opened.now + step, until), stimulus, outputs)
        if progress:
            progress(opened.now / stimulus.end)
