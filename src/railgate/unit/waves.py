"""The pins and states of the whole unit in spans of a run, on one time base."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction

from railgate.engines import Engine, open_engine
from railgate.engines.signals import parts
from railgate.position_link.design import design as link_design
from railgate.unit.run import Run
from railgate.unit.sensing import rate
from railgate.vital_output.loop import loop
from railgate.vital_output.plant.edges import FEMTOSECOND
from railgate.waves import Trace

__all__ = ["GROUPS", "Span", "joined", "waves"]

Span = tuple[Fraction, Fraction]
"""Seconds since the run's start."""

GROUPS = {
    "wheel sensors": ("sensor.",),
    "position link": ("link.",),
    "FPGA 1": ("fpga_1.",),
    "FPGA 2": ("fpga_2.",),
    "relay": ("contact",),
}
"""What a viewer shows together: a title, and how the names of its signals begin."""

LINK = ("anf", "delivery", "status", "age", "health", "causes")
FRAMES = tuple(f"fpga_{n}.command.valid" for n in (1, 2))
CHANNEL = ("pulses", "image", "life", "linked", "trusted", "test_phase", "first_cause")


def joined(spans: Iterable[Span]) -> list[Span]:
    """The spans in order, those that touch as one."""
    found: list[Span] = []
    for start, end in sorted(spans):
        if found and start <= found[-1][1]:
            found[-1] = found[-1][0], max(found[-1][1], end)
        else:
            found.append((start, end))
    return found


def waves(run: Run, spans: Sequence[Span]) -> Iterator[Trace]:
    """One for each span, in femtoseconds since the run's start: what came to the pins, and what
    came of it, from a second pass through the run's own inputs.

    spans: in order, apart from one another, inside the run.
    """
    odometer = run.odometers[0].stimulus
    sensors = _real(run, odometer)
    parted = zip(_parts(sensors, spans), _link(run, spans), _vital(run, spans), strict=True)
    yield from map(_together, parted)


def _together(traces: Sequence[Trace]) -> Trace:
    first, *others = traces
    for other in others:
        first = first.merge(other)
    return first


def _real(run: Run, trace: Trace) -> Trace:
    """What FPGA 1's clocks count, as it is by an exact clock."""
    return Trace(trace.signals, trace.period / rate(run.scenario, 1), trace.start, trace.end)


def _parts(trace: Trace, spans: Sequence[Span]) -> Iterator[Trace]:
    for span in spans:
        start, end = (int(time / trace.period) for time in span)
        cut = trace.slice(max(start - 1, trace.start), min(end + 1, trace.end))
        yield _within(cut.resample(FEMTOSECOND), span)


def _within(trace: Trace, span: Span) -> Trace:
    start, end = (int(time / FEMTOSECOND) for time in span)
    return trace.extend(max(end, trace.end)).slice(start, end)


def _link(run: Run, spans: Sequence[Span]) -> Iterator[Trace]:
    stimulus = run.link.stimulus
    config = run.scenario.config.link
    engine = open_engine(link_design(config), "leap")
    ticks = config.clock_hz * rate(run.scenario, 1)
    for span in spans:
        start, end = int(span[0] * ticks) - 1, int(span[1] * ticks) + 2
        cut = _between(engine, stimulus, max(start, engine.now), end, LINK)
        real = _real(run, cut.merge(stimulus.slice(cut.start, cut.end)))
        named = real.rename({name: f"link.{name}" for name in real.signals})
        yield _within(named.resample(FEMTOSECOND), span)


def _vital(run: Run, spans: Sequence[Span]) -> Iterator[Trace]:
    vital = run.vital
    config, scenario = vital.config, vital.scenario
    stimulus = vital.stimulus
    engine = open_engine(loop(config, scenario.relay, scenario.clocks(config)), "leap")
    states = [name for name, *_ in parts("states", 3 * config.outputs)]
    names = ["contact", *(f"fpga_{n}.{name}" for n in (1, 2) for name in (*CHANNEL, *states))]
    for span in spans:
        start, end = (int(time / FEMTOSECOND) for time in span)
        cut = _between(engine, stimulus, start, end, names)
        yield cut.merge(stimulus.select(FRAMES).slice(cut.start, cut.end))


def _between(engine: Engine, stimulus: Trace, start: int, end: int, names: Sequence[str]) -> Trace:
    """What the engine makes of its inputs in a span of them."""
    engine.advance(start, stimulus, [])
    return engine.advance(min(end, stimulus.end), stimulus, names)
