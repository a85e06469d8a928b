"""What happened in a run, as a list of events in order of time."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import groupby
from math import ceil, floor

from railgate.vital_output.observed import Observed
from railgate.vital_output.plant.edges import femtoseconds
from railgate.vital_output.plant.faults import FAULTS
from railgate.vital_output.plant.scenario import Scenario
from railgate.vital_output.spec import Config, State, TestPhase
from railgate.vital_output.verdict import Closing, Verdict

__all__ = ["NAMES", "Event", "folded", "hexadecimal", "named", "seconds", "timeline"]

SECOND = 10**15
"""Femtoseconds."""

NAMES = {
    State.IDLE: "idle",
    State.PRE_DRIVE: "pre-drive",
    State.DRIVE: "drive",
    State.WAIT: "wait",
    State.TEST: "test",
    State.HANDSHAKE_ALARM: "handshake alarm",
    State.FEEDBACK_ALARM: "feedback alarm",
}
PULSING = (State.DRIVE, State.TEST)

FRAMES = {
    "accepted": "accepted",
    "start": "begins a sequence",
    "format": "rejected: format",
    "time": "rejected: time not trusted",
    "comparator": "rejected: comparator",
    "corruption": "rejected: corruption",
    "delay": "rejected: delay",
    "masquerade": "rejected: masquerade",
    "repetition": "rejected: repetition",
    "resequence": "rejected: resequence",
    "insertion": "rejected: insertion",
}
"""What a counter says of the frame that it counts."""

UNREADABLE = ("format", "corruption")
"""Of such a frame nothing is known, not even its number."""

PLAIN = {
    "passed": "vote passed",
    "skew": "vote failed: only one of the two frames came within τ0",
    "mismatch": "vote failed: the frames of CPU 1 and CPU 2 differ",
    "forward": "vote: the frame that {peer} forwarded does not pass here",
    "link_check": "message of {peer} rejected: check",
    "link_digest": "message of {peer} rejected: another configuration",
    "link_sequence": "message of {peer} rejected: out of sequence",
    "link_lost": "link of {peer} lost",
    "oscillator": "clock of {peer} off its tolerance",
    "time_jump": "time that is given is off by more than the margin",
    "latched": "latched: frames rejected too often",
    "upset": "upset",
}
"""What a counter says; those of alarms and of a life's end go with what they change."""

LEVELS = {
    ("trusted", 1): "time trusted",
    ("trusted", 0): "time not trusted",
    ("linked", 1): "link of {peer} up",
    ("drifting", 0): "clock of {peer} in tolerance again",
    ("latched", 0): "latch free",
}
"""What a flag says when it becomes this; what is missing here a counter says."""

MANY = 3
"""Of more events alike in one cycle only the first is shown."""
NUMBERS = re.compile(r"(?<=frame )\d+|\d+(?= × in this cycle)")
"""What may differ between events that are alike."""
EARLIER = 1e-9
"""A part of a cycle: an event at a cycle's beginning is of that cycle, however it is rounded."""


@dataclass(frozen=True)
class Event:
    """Something that happened at a time.

    source: `FPGA 1`, `FPGA 2`, `CPUs`, `relay`, `fault`; empty where it tells of other events.
    """

    time_s: float
    source: str
    what: str


def timeline(
    config: Config, scenario: Scenario, channels: Sequence[Observed], verdict: Verdict
) -> list[Event]:
    """All events of a run; those of one moment in the order of cause and effect."""
    events = [
        *_faults(scenario),
        *_commands(config, scenario),
        *(event for channel in channels for event in _channel(channel)),
        *_contacts(verdict),
    ]
    return sorted(events, key=lambda event: event.time_s)


def folded(events: Iterable[Event], cycle_s: Fraction) -> list[Event]:
    """The events as a person reads them: cycles like the one before are only counted."""
    found: list[Event] = []
    alike: list[Event] = []
    before: tuple[int, Counter[tuple[str, str]]] | None = None
    of_cycle = groupby(events, lambda event: floor(event.time_s / float(cycle_s) + EARLIER))
    for cycle, (*each,) in of_cycle:
        thinned = _thinned(each)
        kinds = Counter(map(_kind, thinned))
        if (cycle - 1, kinds) == before:
            alike.append(each[0])
        else:
            found += [*_stretch(alike), *thinned]
            alike = []
        before = cycle, kinds
    return [*found, *_stretch(alike)]


def _kind(event: Event) -> tuple[str, str]:
    return event.source, NUMBERS.sub("", event.what)


def _thinned(events: Sequence[Event]) -> list[Event]:
    """The events of one cycle; of many alike the first, with their number."""
    counts = Counter(map(_kind, events))
    shown = []
    for event in events:
        count = counts[kind := _kind(event)]
        if count > MANY:
            counts[kind] = 0
            event = replace(event, what=f"{event.what}, {count} × in this cycle")
        if count:
            shown.append(event)
    return shown


def _stretch(cycles: Sequence[Event]) -> list[Event]:
    if not cycles:
        return []
    plural = "s" * (len(cycles) > 1)
    return [Event(cycles[0].time_s, "", f"… {len(cycles)} cycle{plural} alike …")]


def _faults(scenario: Scenario) -> Iterator[Event]:
    for fault in scenario.faults:
        name = fault.kind if fault.value is None else f"{fault.kind}:{fault.value}"
        yield Event(float(fault.start_s), "fault", f"{name}: {FAULTS[fault.kind].does}")
        if fault.end_s is not None and fault.end_s < scenario.seconds:
            yield Event(float(fault.end_s), "fault", f"{name} ends")


def _commands(config: Config, scenario: Scenario) -> Iterator[Event]:
    for time in scenario.tests_s:
        yield Event(float(time), "CPUs", "test of the shut-off paths demanded")
    for command in scenario.commands:
        begin = ceil(command.start_s / config.cycle_s) * config.cycle_s
        told = f"image {hexadecimal(config, command.image)}"
        if command.acknowledge:
            told += f", acknowledge {hexadecimal(config, command.acknowledge)}"
        if begin < scenario.seconds:
            yield Event(float(begin), "CPUs", f"command {told}")


def hexadecimal(config: Config, image: int) -> str:
    """A digit for each four outputs."""
    return f"0x{image:0{-(-config.outputs // 4)}x}"


def seconds(time_s: float) -> str:
    """A time to the microsecond: `0.412 613`."""
    told = f"{time_s:.6f}"
    return f"{told[:-3]} {told[-3:]}"


def _channel(channel: Observed) -> Iterator[Event]:
    """What one FPGA went through."""
    source, peer = f"FPGA {channel.fpga}", f"FPGA {3 - channel.fpga}"
    told = [
        *((at, "is reset") for at in channel.resets.tolist()),
        *_frames(channel),
        *_counts(channel),
        *_levels(channel),
        *_life(channel),
        *_states(channel),
    ]
    return (Event(at / SECOND, source, what.format(peer=peer)) for at, what in told)


def _frames(channel: Observed) -> Iterator[tuple[int, str]]:
    for name, what in FRAMES.items():
        for at, _ in channel.counted(name):
            values = channel.judged(at).values
            if values is None or name in UNREADABLE:
                yield at, f"frame {what}"
            else:
                image = hexadecimal(channel.config, values["image"])
                yield at, f"frame {values['sequence']}, image {image}, {what}"
    for at, step in channel.counted("lost"):
        yield at, f"{step} frame{'s' * (step > 1)} lost"


def _counts(channel: Observed) -> Iterator[tuple[int, str]]:
    for name, what in PLAIN.items():
        yield from ((at, what) for at, _ in channel.counted(name))


def _levels(channel: Observed) -> Iterator[tuple[int, str]]:
    for name in sorted({name for name, _ in LEVELS}):
        for at, _, new in channel.changes(name):
            if what := LEVELS.get((name, new)):
                yield at, what
    for at, old, new in channel.changes("test_phase"):
        phases = (TestPhase(code).name.lower() for code in (old, new))
        yield at, f"test of the shut-off paths: {' → '.join(phases)}"
    for at, old, new in channel.changes("blocked"):
        for bits, what in ((old & ~new, "may drive: a live 0 has come"), (new & ~old, "blocked")):
            if bits:
                yield at, f"{named(bits)} {what}"


def _life(channel: Observed) -> Iterator[tuple[int, str]]:
    """What is stored, how long it lives, and what becomes of it."""
    image, life = channel.wave("image"), channel.wave("life")
    told = set()
    for at, _ in channel.counted("stored"):
        told.add(at)
        yield at, f"stored: image {_image(channel, int(image.at(at)))}, life {life.at(at)}"
    for at, old, new in channel.changes("life"):
        if at not in told:
            told.add(at)
            yield at, f"life {old} → {new}{', the image is forced to 0' * (not new)}"
    for at, old, new in channel.changes("image"):
        if at not in told:
            yield at, f"image {_image(channel, old)} → {_image(channel, new)}"
    for at, old, new in channel.changes("acknowledge"):
        if rises := new & ~old:
            yield at, f"{named(rises)} acknowledged"


def _image(channel: Observed, image: int) -> str:
    return hexadecimal(channel.config, image)


def _states(channel: Observed) -> Iterator[tuple[int, str]]:
    """Outputs that do the same in the same tick are told together."""
    together: dict[tuple[int, int, int], int] = {}
    for output in range(channel.config.outputs):
        for change in channel.transitions(output):
            together[change] = together.get(change, 0) | 1 << output
    for (at, old, new), outputs in together.items():
        before, after = State(old), State(new)
        pulses = ""
        if (before in PULSING) != (after in PULSING):
            pulses = f", pulses {'on' if after in PULSING else 'off'}"
        yield at, f"{named(outputs)}: {NAMES[before]} → {NAMES[after]}{pulses}"


def named(outputs: int) -> str:
    """`output 3`, `outputs 0–2, 5` of these bits."""
    bits = [bit for bit in range(outputs.bit_length()) if outputs >> bit & 1]
    followed = groupby(enumerate(bits), lambda each: each[1] - each[0])
    runs = [[bit for _, bit in run] for _, run in followed]
    told = (f"{run[0]}" if len(run) == 1 else f"{run[0]}–{run[-1]}" for run in runs)
    return f"output{'s' * (len(bits) > 1)} {', '.join(told)}"


def _contacts(verdict: Verdict) -> Iterator[Event]:
    together: dict[tuple[int, str], int] = {}
    for each in verdict.closings:
        for at, what in _contact(each, verdict):
            together[at, what] = together.get((at, what), 0) | 1 << each.output
    for (at, what), outputs in together.items():
        yield Event(at / SECOND, "relay", f"{named(outputs)}: {what}")


def _contact(each: Closing, verdict: Verdict) -> Iterator[tuple[int, str]]:
    yield each.closed, "contact closes" + " without a live 1" * each.late
    if verdict.too_long(each):
        backed = max(each.closed, each.live or 0)
        yield backed + femtoseconds(verdict.declared_s), "contact closed longer than declared"
    if not each.lasts:
        since = ""
        if each.since_live_s is not None and not each.late:
            since = f", {float(each.since_live_s) * 1e3:.3f} ms after the last live 1"
        yield each.opened, f"contact opens{since}"
