"""Whether a run was safe: no door contact closed where it must not be, for longer than declared."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from railgate.unit.route import Call, Side
from railgate.unit.run import Run
from railgate.vital_output.verdict import Closing
from railgate.waves import Waveform

__all__ = ["Release", "Verdict", "judge"]

SECOND = 1e15
"""Femtoseconds."""
Span = tuple[float, float]


@dataclass(frozen=True)
class Release:
    """A span in which the doors of a side were released while the train, in truth, moved, or stood
    at no platform on that side. where: what was wrong with it, in words."""

    side: Side
    start_s: float
    end_s: float
    where: str

    def __str__(self) -> str:
        return (
            f"{self.side.name.lower()} doors released {self.where} for "
            f"{self.end_s - self.start_s:.3f} s from {self.start_s:.3f} s on"
        )


@dataclass(frozen=True)
class Verdict:
    """declared_s: the reaction time, which every wrong span may last, since the unit needs as long
    to react to a failure. overdue: contacts closed longer than that after the last agreed, live 1
    (DRV-16). wrong: releases in motion or at no platform that lasted longer."""

    declared_s: Fraction
    overdue: tuple[Closing, ...]
    wrong: tuple[Release, ...]

    @property
    def safe(self) -> bool:
        return not self.overdue and not self.wrong

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why it was not safe, a sentence each."""
        late = (
            f"{Side(each.output).name.lower()} doors: the contact stayed closed "
            f"{float(each.unbacked_s):.3f} s without an agreed, live 1"
            for each in self.overdue
        )
        return (*late, *map(str, self.wrong))


def judge(run: Run) -> Verdict:
    """Of a whole run, against the train's true motion."""
    contact, end_s = run.vital.trace["contact"], run.vital.trace.end / SECOND
    calls = run.scenario.route.calls
    declared = run.vital.verdict.declared_s
    wrong = [
        Release(side, start, end, _where(calls, start, end))
        for side in Side
        for closed in _closed(contact, side, end_s)
        for start, end in _outside(closed, calls, side)
        if end - start > declared
    ]
    wrong.sort(key=lambda each: each.start_s)
    return Verdict(declared, run.vital.verdict.violations, tuple(wrong))


def _closed(contact: Waveform, side: Side, end_s: float) -> Iterator[Span]:
    wave = Waveform.of(contact.ticks, contact.values >> side.value & 1)
    turns = [*(wave.ticks / SECOND).tolist(), end_s]
    for number, value in enumerate(wave.values.tolist()):
        if value:
            yield turns[number], turns[number + 1]


def _outside(closed: Span, calls: tuple[Call, ...], side: Side) -> Iterator[Span]:
    """The parts of a span in which the train does not stand at a platform on this side."""
    start, end = closed
    for call in calls:
        if call.stop.side is side and call.departs_s > start:
            if start < min(call.arrives_s, end):
                yield start, min(call.arrives_s, end)
            start = call.departs_s
    if start < end:
        yield start, end


def _where(calls: tuple[Call, ...], start: float, end: float) -> str:
    stood = [call for call in calls if call.arrives_s < end and start < call.departs_s]
    covered = sum(min(call.departs_s, end) - max(call.arrives_s, start) for call in stood)
    told = [f"on the wrong side at {call.stop.at_m:g} m" for call in stood]
    return " and ".join((["in motion"] if covered < end - start else []) + told)
