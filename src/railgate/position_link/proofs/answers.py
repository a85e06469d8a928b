"""What is read from the line: the causes, and the word that they forbid."""

from __future__ import annotations

from functools import partial

from amaranth.hdl import Module

from railgate.position_link.proofs.stimuli import GOOD, NOTHING, WORD, Answer, mutant, run
from railgate.position_link.proofs.supervised import Supervised
from railgate.position_link.spec import CRC16, EVEN, Config, Edge, Status
from railgate.proving import Claim, Induction

__all__ = ["CLAIMS"]

DEFAULT = Config()
CHECKED = Config(check=CRC16)
OTHERWISE = Config(
    sampling_edge=Edge.RISING,
    timeout_from_end=True,
    earliest_clk=1,
    guard_ticks=1,
    check=EVEN,
    zero_is_fault=True,
)
PAYLOAD = WORD >> 16 | 1 << 47


class _Causes(Supervised):
    """The causes delivered are those of the contract, and no other."""

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.link(m)
        m.d.comb += [
            self.holds.eq(inner["causes"] == self.found),
            self.reached.eq(self.found[3] & inner["delivery"]),
        ]
        return m


class _Fresh(Supervised):
    """FRESH is the word of this cycle's answer, and the cycle has no cause."""

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.link(m)
        fresh = inner["status"] == Status.FRESH
        m.d.comb += [
            self.holds.eq(~fresh | ((self.found == 0) & self.good & (inner["word"] == self.read))),
            self.reached.eq(fresh),
        ]
        return m


def _checked(payload: int, covered: int = 48) -> Answer:
    """A word with the check of its last so many bits before it."""
    return Answer(payload << 16 | CRC16.of(payload & (1 << covered) - 1, covered))


LAST_TICK_LOST = mutant(
    "last-tick-lost",
    "timing",
    "self.decided.eq(since_decision[3])",
    "self.decided.eq(since_decision[2])",
    run(DEFAULT, [GOOD, Answer(0, clk=96, bits=2, late_ticks=0)]),
)

CLAIMS = (
    Claim(
        name="position_link.causes",
        claim=(
            "For ever, the causes delivered are those that the contract finds on the pins between "
            "one decision and the next, each in its tick, and no other: TIMEOUT, EARLY, SHORT, "
            "LONG, STUCK, UNREQUESTED, UNSTABLE, FAULT_WORD (default configuration)."
        ),
        requirements=("LNK-3", "LNK-4", "LNK-5", "LNK-7"),
        monitor=partial(_Causes, DEFAULT),
        method=Induction(),
        cover=run(DEFAULT, [Answer(WORD, clk=12, bits=65)]),
        mutants=(
            LAST_TICK_LOST,
            mutant(
                "first-tick-lost",
                "reader",
                "Mux(self.decided, 0, self.causes) | happened | unstable",
                "Mux(self.decided, 0, self.causes | happened | unstable)",
                run(DEFAULT, [GOOD, Answer(0, clk=96, bits=2, late_ticks=1)], [GOOD]),
            ),
            mutant(
                "early-passes",
                "timing",
                "2 * (config.earliest_clk - 1)",
                "2 * (config.earliest_clk - 2)",
                run(DEFAULT, [Answer(WORD, clk=1)]),
            ),
            mutant(
                "short-passes",
                "reader",
                "events[Cause.SHORT] = lacking & ends",
                "events[Cause.SHORT] = lacking & ends & ~last",
                run(DEFAULT, [Answer(WORD, bits=63)]),
            ),
            mutant(
                "long-passes",
                "reader",
                "whole & samples & ~ends",
                "whole & samples & ends",
                run(DEFAULT, [Answer(WORD, bits=65)]),
            ),
            mutant(
                "second-answer-passes",
                "reader",
                "self.starts | ~answered)",
                "self.starts | ~answered | ~self.complete)",
                run(DEFAULT, [Answer(0, clk=3, bits=4), GOOD]),
            ),
            mutant(
                "stuck-passes",
                "reader",
                "self.starts & self.uef & ~self.uef_rise",
                "self.starts & self.uef_rise",
                run(DEFAULT, [Answer(0, clk=50, bits=11_000)], NOTHING),
            ),
            mutant(
                "moves-after-the-sample",
                "reader",
                "moved & (taken | holding.active)",
                "moved & taken",
                run(DEFAULT, [Answer(WORD, late_ticks=41)]),
            ),
            mutant(
                "moves-before-the-sample",
                "reader",
                "taken & settling.active",
                "taken & moved",
                run(DEFAULT, [Answer(WORD, late_ticks=36)]),
            ),
        ),
        fast=False,
    ),
    Claim(
        name="position_link.causes-otherwise",
        claim=(
            "For ever, and with the other choices too, the causes delivered are those that the "
            "contract finds, CHECK and ZERO_WORD among them (sampling_edge RISING, "
            "timeout_from_end, earliest_clk = 1, guard_ticks = 1, check = EVEN, zero_is_fault)."
        ),
        requirements=("LNK-3", "LNK-4", "LNK-5", "LNK-7"),
        monitor=partial(_Causes, OTHERWISE),
        method=Induction(),
        cover=run(OTHERWISE, [Answer(0, bits=65)]),
        mutants=(
            mutant(
                "samples-falls",
                "timing",
                "delayed.falls if falling else delayed.rises",
                "delayed.falls",
                run(OTHERWISE, [Answer(WORD, late_ticks=39)]),
            ),
            mutant(
                "zero-passes",
                "verdict",
                "is_zero.eq(self.complete &",
                "is_zero.eq(0 &",
                run(OTHERWISE, [Answer(0)]),
            ),
            mutant(
                "parity-passes",
                "verdict",
                "check_fails.eq(self.complete & differs)",
                "check_fails.eq(0)",
                run(OTHERWISE, [Answer(WORD ^ 1)]),
            ),
            mutant(
                "from-the-rise-of-anf",
                "timing",
                '"closes": 2 * config.window_bits',
                '"closes": 2 * config.timeout_bits',
                run(OTHERWISE, [Answer(WORD, clk=36)]),
            ),
        ),
        fast=False,
    ),
    Claim(
        name="position_link.fresh",
        claim=(
            "For ever, a word delivered as FRESH is, bit for bit, what the pin DATA told at the "
            "64 samples of this cycle's one answer, and this cycle has no cause at all "
            "(default configuration)."
        ),
        requirements=("LNK-3", "LNK-4", "LNK-5", "LNK-6"),
        monitor=partial(_Fresh, DEFAULT),
        method=Induction(),
        cover=run(DEFAULT, [GOOD]),
        mutants=(
            LAST_TICK_LOST,
            mutant(
                "early-ignored",
                "verdict",
                "clear.eq(self.seen == 0)",
                "clear.eq((self.seen & ~Cause.EARLY) == 0)",
                run(DEFAULT, [Answer(0, clk=1, bits=3), GOOD]),
            ),
            mutant(
                "a-bit-less-will-do",
                "reader",
                "last.eq(bits == config.word_bits - 2)",
                "last.eq(bits == config.word_bits - 3)",
                run(DEFAULT, [Answer(WORD, bits=63)]),
            ),
            mutant(
                "last-bit-first",
                "reader",
                "Cat(bit, self.word)",
                "Cat(self.word[1:], bit)",
                run(DEFAULT, [GOOD]),
            ),
        ),
        fast=False,
    ),
    Claim(
        name="position_link.fresh-checked",
        claim=(
            "For ever, and with a CRC of 16 bits in the word's last bits, a word delivered as "
            "FRESH is what DATA told in this cycle, its CRC is right, and the cycle has no cause "
            "(default configuration, but with check = CRC16)."
        ),
        requirements=("LNK-5", "LNK-7"),
        monitor=partial(_Fresh, CHECKED),
        method=Induction(),
        cover=run(CHECKED, [_checked(PAYLOAD)]),
        mutants=(
            mutant(
                "part-compared",
                "verdict",
                "self.word[: config.check.width] ^ self.check",
                "(self.word ^ self.check)[1 : config.check.width]",
                run(CHECKED, [Answer(_checked(PAYLOAD).word ^ 1)]),
            ),
            mutant(
                "first-bit-uncovered",
                "reader",
                "check.enable.eq(taken & covered)",
                "check.enable.eq(taken & covered & (bits != 0))",
                run(CHECKED, [_checked(PAYLOAD, 47)]),
            ),
            mutant(
                "never-checked",
                "verdict",
                "check_fails.eq(self.complete & differs)",
                "check_fails.eq(0)",
                run(CHECKED, [GOOD]),
            ),
        ),
        fast=False,
    ),
)
