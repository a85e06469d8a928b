"""The faults of a run, and how each was found: what the unit told next, and how long after."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from railgate.unit.conditions import clocks_off
from railgate.unit.events import Event
from railgate.unit.faults import FAULTS, Fault
from railgate.unit.scenario import Scenario

__all__ = ["Finding", "Injected", "injected"]

COMPLAINTS = {
    "wheel": re.compile(r"axle {axle}\b.*"),
    "link": re.compile(r"(warning|alarm|recovering|start)\b.*"),
    "vital": re.compile(
        r".*(rejected|failed|lost|is reset|off its tolerance|not trusted|off by|does not pass"
        r"|latched|alarm|upset|forced to 0|longer than declared|without a live 1)\b.*"
        r"|.*contact opens\b.*"
    ),
}
"""What the unit says of a fault of a part, not of what it does all the time."""
SOURCES = {
    "wheel": ("odometer 1", "odometer 2"),
    "link": ("position link",),
    "vital": ("FPGA 1", "FPGA 2", "relay"),
}
"""Who says it."""
AFTERWARDS_S = 1.0
"""So long after a fault's end it may still be found."""
PER_SOURCE = 3
"""Findings of one source."""
NUMBERS = re.compile(r"\d+")


@dataclass(frozen=True)
class Finding:
    """What told of a fault: source and what as in the event, delay_s after the fault began."""

    delay_s: float
    source: str
    what: str


@dataclass(frozen=True)
class Injected:
    """A fault. what: which. does: what it does. end_s: None where it lasts to the run's end.
    found: the first of each source that told of it, in order of time."""

    part: str
    what: str
    does: str
    start_s: float
    end_s: float | None
    found: tuple[Finding, ...]


def injected(scenario: Scenario, events: Sequence[Event]) -> tuple[Injected, ...]:
    """All faults of a scenario in order of time, a clock off its tolerance among them."""
    found = [
        *_clocks(scenario, events),
        *(_injected(scenario, each, events) for each in scenario.faults),
    ]
    return tuple(sorted(found, key=lambda each: each.start_s))


def _injected(scenario: Scenario, fault: Fault, events: Sequence[Event]) -> Injected:
    """A fault of the link hits all of the cycle it begins in, so that it may be told before it."""
    start = float(fault.start_s)
    early = float(scenario.config.link.cycle_s) if fault.part == "link" else 0.0
    end = None if fault.end_s is None else float(fault.end_s)
    until = float("inf") if end is None else end + AFTERWARDS_S
    complaint = re.compile(COMPLAINTS[fault.part].pattern.replace("{axle}", str(fault.axle)))
    told = (
        event
        for event in events
        if start - early <= event.time_s <= until
        and event.source in SOURCES[fault.part]
        and complaint.fullmatch(event.what)
    )
    kind = fault.kind.replace("-", " ")
    unit = " %" if fault.part == "wheel" else ""
    value = "" if fault.value is None else f" {fault.value}{unit}"
    name = {"wheel": f"axle {fault.axle}: {kind}", "link": f"position link: {kind}"}
    return Injected(
        part=fault.part,
        what=name.get(fault.part, kind) + value,
        does=FAULTS[fault.part][fault.kind].partition("; value")[0],
        start_s=start,
        end_s=end,
        found=tuple(_first(told, start)),
    )


def _clocks(scenario: Scenario, events: Sequence[Event]) -> Iterator[Injected]:
    for fpga, ppm in clocks_off(scenario):
        told = (event for event in events if "off its tolerance" in event.what)
        yield Injected(
            part="clock",
            what=f"clock of FPGA {fpga}: {ppm:+g} ppm",
            does="it runs faster or slower than the unit is built for",
            start_s=0.0,
            end_s=None,
            found=tuple(_first(told, 0.0)),
        )


def _first(events: Iterable[Event], start_s: float) -> Iterator[Finding]:
    """The first of each kind, at most three of each source."""
    seen: dict[str, set[str]] = {}
    for event in events:
        kinds = seen.setdefault(event.source, set())
        kind = NUMBERS.sub("", event.what)
        if kind not in kinds and len(kinds) < PER_SOURCE:
            kinds.add(kind)
            yield Finding(max(event.time_s - start_s, 0.0), event.source, event.what)
