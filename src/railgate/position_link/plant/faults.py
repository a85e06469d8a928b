"""What can be wrong outside the link, by name and time."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction

from railgate.position_link.plant.effects import (
    Effect,
    answers_at,
    bit_error,
    drift,
    glitch,
    lasts,
    missing,
    noise,
    second,
    sends,
    stuck,
    unplugged,
    unrequested,
)
from railgate.quantity import span_s, time_s

__all__ = ["FAULTS", "Fault", "Kind", "fault"]

FORM = re.compile(r"\s*([\w-]+)(?::([^@]*))?@(.*)", re.DOTALL)
NUMBER = re.compile(r"\s*-?[0-9]{1,12}\s*")


@dataclass(frozen=True)
class Kind:
    """does: what the fault does. value: what its number means, empty where it takes none. default:
    the number that it has by itself. on_line: it disturbs the line, after all that changes the
    answers."""

    does: str
    value: str
    default: str
    effect: Effect
    on_line: bool = False


FAULTS: dict[str, Kind] = {
    "missing": Kind("the position system does not answer", "", "", missing),
    "short": Kind(
        "UEF is too short",
        "CLK that it lasts",
        "word_bits - 1",
        lasts(lambda config: config.word_bits - 1),
    ),
    "long": Kind(
        "UEF is too long",
        "CLK that it lasts",
        "word_bits + 1",
        lasts(lambda config: config.word_bits + 1),
    ),
    "early": Kind(
        "UEF rises too early",
        "CLK with which it rises",
        "earliest_clk - 1, at least 1",
        answers_at(lambda config: max(1, config.earliest_clk - 1)),
    ),
    "late": Kind(
        "UEF rises too late",
        "CLK with which it rises",
        "the first after the timeout",
        answers_at(lambda config: config.window_bits + 1),
    ),
    "stuck": Kind("UEF holds one level, DATA does not", "the level", "1", stuck, True),
    "unrequested": Kind(
        "UEF rises once more, for 2 CLK",
        "CLK with which it rises",
        "that at three quarters of the cycle",
        unrequested,
    ),
    "second": Kind(
        "a second answer follows the first",
        "CLK with which UEF rises",
        "1 CLK after the first has ended",
        second,
    ),
    "bit-error": Kind(
        "one bit of DATA is inverted on the line",
        "which one, the first sent is 1",
        "1",
        bit_error,
        True,
    ),
    "unplugged-low": Kind("UEF and DATA both hold 0", "", "", unplugged("low"), True),
    "unplugged-high": Kind("UEF and DATA both hold 1", "", "", unplugged("high"), True),
    "noise": Kind(
        "UEF and DATA are inverted and back at random",
        "mean ticks from change to change",
        "half a bit",
        noise,
        True,
    ),
    "drift": Kind(
        "the delay grows, evenly over the cycles hit, and stays so",
        "ticks that it grows by, negative where it shrinks",
        "half a bit, at most 128",
        drift,
    ),
    "fault-word": Kind(
        "the position system sends the fault word",
        "",
        "",
        sends(lambda config: config.invalid_word),
    ),
    "zero-word": Kind("the position system sends the word 0", "", "", sends(lambda _: 0)),
    "glitch": Kind(
        "UEF is inverted for a few ticks, from TIME on; in a span again after each cycle",
        "ticks",
        "filter_ticks, at least 1",
        glitch,
        True,
    ),
}
"""The kinds of fault by name: KIND@TIME hits the cycle in which TIME falls, KIND@T0..T1 each cycle
that the span touches; stuck, unplugged-low, unplugged-high and noise just the span's ticks."""


@dataclass(frozen=True)
class Fault:
    """One kind of FAULTS from a time on until another, or in one cycle where there is none.

    Times are in seconds from where cycle 0 begins. value: None is the kind's default.
    """

    kind: str
    start_s: Fraction
    end_s: Fraction | None = None
    value: int | None = None

    def __post_init__(self) -> None:
        if self.kind not in FAULTS:
            raise ValueError(f'a fault must be one of {", ".join(FAULTS)}, not "{self.kind}"')
        if self.start_s < 0:
            raise ValueError(
                f"{self.kind} must begin at 0 s at the earliest, not {float(self.start_s):g} s"
            )
        if self.end_s is not None and not self.start_s < self.end_s:
            raise ValueError(
                f"{self.kind} must end after it begins at {float(self.start_s):g} s, "
                f"not at {float(self.end_s):g} s"
            )
        if self.value is not None and not FAULTS[self.kind].value:
            raise ValueError(f"{self.kind} takes no value, not {self.value}")


def fault(text: str) -> Fault:
    """`short@0.1s`, `stuck@60ms..140ms`, `late:40@20ms` -> the fault. Raises ValueError."""
    found = FORM.fullmatch(text)
    if not found or (found[2] is not None and not NUMBER.fullmatch(found[2])):
        raise ValueError(
            "a fault must be KIND@TIME, KIND@T0..T1 or, with a whole number, KIND:VALUE@TIME, "
            f"KIND of {', '.join(FAULTS)}, not {text!r}"
        )
    kind, time = found[1], found[3]
    value = None if found[2] is None else int(found[2])
    if kind not in FAULTS:
        raise ValueError(f'a fault must be one of {", ".join(FAULTS)}, not "{kind}"')
    start, end = span_s(time) if ".." in time else (time_s(time), None)
    return Fault(kind, start, end, value)
