"""What a run was in, as lanes of coloured spans over time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railgate.odometer.host import Verdict
from railgate.position_link.spec import Health, Status
from railgate.unit.result import Result
from railgate.unit.route import Side
from railgate.vital_output.spec import State
from railgate.vital_output.timeline import NAMES
from railgate.waves import Waveform

__all__ = ["HEALTHS", "MOST", "Lane", "Span", "lanes", "stretches"]

SECOND = 1e15
"""Femtoseconds."""
MOST = 2_000
"""Spans of a lane; of more, a lane is drawn in so many steps."""

Span = tuple[float, float, str, str]
"""Begin and end, s, what it was, and its tone: which colour that has."""
Look = Mapping[int, tuple[str, str]]
"""Of each value that is drawn, what it is called, and its tone."""

STATES: Look = {
    State.PRE_DRIVE: (NAMES[State.PRE_DRIVE], "amber"),
    State.DRIVE: (NAMES[State.DRIVE], "green"),
    State.WAIT: (NAMES[State.WAIT], "blue"),
    State.TEST: (NAMES[State.TEST], "violet"),
    State.HANDSHAKE_ALARM: (NAMES[State.HANDSHAKE_ALARM], "red"),
    State.FEEDBACK_ALARM: (NAMES[State.FEEDBACK_ALARM], "red"),
}
HEALTHS: Look = {
    Health.START: ("start", "grey"),
    Health.OK: ("ok", "green"),
    Health.WARNING: ("warning", "amber"),
    Health.ALARM: ("alarm", "red"),
    Health.RECOVERING: ("recovering", "violet"),
}
STATUSES: Look = {
    Status.FRESH: ("fresh", "green"),
    Status.HELD: ("held", "amber"),
    Status.FAULT: ("fault word", "red"),
}
STANDS: Look = {1: ("standstill", "blue")}
COMMANDED: Look = {1: ("release commanded", "ink")}
CLOSED: Look = {1: ("closed: doors released", "ink")}
VERDICTS: Look = {
    Verdict.SLIPPING: ("slipping", "amber"),
    Verdict.SLIDING: ("sliding", "violet"),
    Verdict.LOST: ("lost", "red"),
}
OUTSIDE: Look = {1: ("the true speed is outside", "red")}


@dataclass(frozen=True)
class Lane:
    """name: of what. idle: what it was where no span is."""

    name: str
    idle: str
    spans: Sequence[Span]


def lanes(result: Result) -> list[Lane]:
    """All of a run, from what is outside down to the contacts."""
    return [
        _platforms(result),
        *_faults(result),
        *_position(result),
        *_odometers(result),
        *(lane for side in Side for lane in _doors(result, side)),
    ]


def _platforms(result: Result) -> Lane:
    calls = result.run.scenario.route.calls
    spans = [
        (call.arrives_s, call.departs_s, f"{call.stop.at_m:g} m, {_name(call.stop.side)}", "soft")
        for call in calls
    ]
    return Lane("platform", "on the way", spans)


def _faults(result: Result) -> Iterator[Lane]:
    end = float(result.run.scenario.seconds)
    parts: dict[str, list[Span]] = {}
    for each in result.injected:
        until = end if each.end_s is None else min(each.end_s, end)
        span = (each.start_s, until, each.what, "magenta")
        parts.setdefault(each.part, []).append(span)
    for part, spans in parts.items():
        yield Lane(f"fault: {part}", "none", sorted(spans))


def _position(result: Result) -> Iterator[Lane]:
    link, end = result.run.link, float(result.run.scenario.seconds)
    for name, field, look in (
        ("position link", "health", HEALTHS),
        ("position word", "status", STATUSES),
    ):
        yield Lane(name, "none yet", stretches(link.times_s, link.told.fields[field], end, look))


def _odometers(result: Result) -> Iterator[Lane]:
    cycles, end = result.run.cycles, float(result.run.scenario.seconds)
    for fpga in (1, 2):
        spans = stretches(cycles.times_s, cycles.stands[:, fpga - 1], end, STANDS)
        yield Lane(f"odometer {fpga}", "moves", spans)
        for axle in range(cycles.verdicts.shape[2]):
            spans = stretches(cycles.times_s, cycles.verdicts[:, fpga - 1, axle], end, VERDICTS)
            if spans:
                yield Lane(f"odometer {fpga}, axle {axle + 1}", "adhering", spans)
        if result.outside[:, fpga - 1].any():
            spans = stretches(cycles.times_s, result.outside[:, fpga - 1], end, OUTSIDE)
            yield Lane(f"odometer {fpga}, speed's interval", "holds", spans)


def _doors(result: Result, side: Side) -> Iterator[Lane]:
    run, bit = result.run, side.value
    end = float(run.scenario.seconds)
    name = f"{_name(side)} doors"
    image = run.cycles.image >> bit & 1
    yield Lane(f"{name}, CPUs", "closed", stretches(run.cycles.times_s, image, end, COMMANDED))
    for channel in run.vital.channels:
        spans = _of_wave(channel.state(bit), end, STATES)
        yield Lane(f"{name}, FPGA {channel.fpga}", NAMES[State.IDLE], spans)
    contact = run.vital.trace["contact"]
    wave = Waveform.of(contact.ticks, contact.values >> bit & 1)
    yield Lane(f"{name}, relay", "open", _of_wave(wave, end, CLOSED))


def _name(side: Side) -> str:
    return side.name.lower()


def _of_wave(wave: Waveform, end: float, look: Look) -> list[Span]:
    return stretches(wave.ticks / SECOND, wave.values, end, look)


def stretches(
    times: NDArray[np.float64], values: NDArray[Any], end: float, look: Look
) -> list[Span]:
    """The stretches of equal values that have a look."""
    turns = np.flatnonzero(np.append(True, values[1:] != values[:-1]))
    starts, kinds = times[turns], values[turns].astype(np.int64)
    ends = np.append(starts[1:], end)
    keep = np.isin(kinds, list(look)) & (ends > starts)
    found = list(zip(starts[keep].tolist(), ends[keep].tolist(), kinds[keep].tolist(), strict=True))
    if len(found) > MOST:
        found = _coarser(found, end)
    return [(start, stop, *look[kind]) for start, stop, kind in found]


def _coarser(spans: list[tuple[float, float, int]], end: float) -> list[tuple[float, float, int]]:
    """The same in steps of a part of the run; of several values in one step the one shows that is
    the rarest in the whole run."""
    lasted: dict[int, float] = {}
    for start, stop, kind in spans:
        lasted[kind] = lasted.get(kind, 0.0) + stop - start
    steps = np.full(MOST, -1)
    for start, stop, kind in sorted(spans, key=lambda span: -lasted[span[2]]):
        first = int(start / end * MOST)
        steps[first : max(ceil(stop / end * MOST), first + 1)] = kind
    turns = np.flatnonzero(np.append(True, steps[1:] != steps[:-1]))
    begins, kinds = (turns * end / MOST).tolist(), steps[turns].tolist()
    told = zip(begins, [*begins[1:], end], kinds, strict=True)
    return [each for each in told if each[2] >= 0]
