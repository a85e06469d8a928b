"""Answers of a position system, for what takes whole cycles to show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

from railgate.position_link.spec import Config
from railgate.proving import TICK, Mutant, Run, Search
from railgate.waves import Trace, Waveform

__all__ = ["GOOD", "NOTHING", "WORD", "Answer", "answers", "mutant", "run"]

FIRST_TICK = 1
"""The tick in which cycle 0 begins."""


@dataclass(frozen=True)
class Answer:
    """One high level of UEF, and DATA along with it.

    word: sent from UEF's rise on, a bit with each rise of CLK. clk: that of UEF's rise, counted
    from one. bits: for how many CLK UEF stays. late_ticks: both lines are so much behind CLK.
    """

    word: int
    clk: int = 12
    bits: int | None = None
    late_ticks: int = 5


NOTHING: tuple[Answer, ...] = ()
WORD = 0x0123_4567_89AB_CDEF
"""Another one from its other end, or a bit further."""
GOOD = Answer(WORD)


def answers(config: Config, *cycles: Sequence[Answer]) -> Trace:
    """The pins over one cycle for each, and over half a cycle more."""
    uef, data = {0: 0}, {0: 0}
    for number, found in enumerate(cycles):
        begin = FIRST_TICK + number * config.cycle_ticks
        for answer in found:
            bits = config.word_bits if answer.bits is None else answer.bits
            edges = [
                begin + config.rise(answer.clk - 1 + n) + answer.late_ticks for n in range(bits + 1)
            ]
            uef |= {edges[0]: 1, edges[-1]: 0}
            for n, edge in enumerate(edges[: config.word_bits]):
                data[edge] = answer.word >> config.word_bits - 1 - n & 1
            data[edges[-1]] = 0
    end = FIRST_TICK + len(cycles) * config.cycle_ticks + config.cycle_ticks // 2
    waves = {
        name: Waveform.of(list(levels), list(levels.values()), 1)
        for name, levels in (("uef", uef), ("data", data))
    }
    return Trace(waves, TICK, 0, end)


def run(config: Config, *cycles: Sequence[Answer]) -> Run:
    """So many cycles, to the delivery of the last one."""
    last = FIRST_TICK + (len(cycles) - 1) * config.cycle_ticks + config.delivery_ticks
    return Run(last + 1, partial(answers, config, *cycles))


def mutant(name: str, file: str, old: str, new: str, rejected: Search | Run) -> Mutant:
    """One of a file of the link's gateware."""
    return Mutant(name, f"railgate.position_link.gateware.{file}", old, new, rejected)
