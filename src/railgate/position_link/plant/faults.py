"""What can be wrong outside the link, by name and time."""

from __future__ import annotations

from dataclasses import dataclass

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
from railgate.timed_fault import TimedFault, parsed

__all__ = ["FAULTS", "Fault", "Kind", "fault"]


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
class Fault(TimedFault):
    """One kind of FAULTS from a time on until another, or in one cycle where there is none; from
    where cycle 0 begins. Raises ValueError."""

    def __post_init__(self) -> None:
        self.require(FAULTS)


def fault(text: str) -> Fault:
    """`short@0.1s`, `stuck@60ms..140ms`, `late:40@20ms` -> the fault. Raises ValueError."""
    return Fault(*parsed(text, FAULTS))
