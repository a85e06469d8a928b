"""What becomes of good and faulty cycles: hold, fault word, recovery."""

from __future__ import annotations

from functools import partial

from amaranth.hdl import Module, Mux

from railgate.position_link.proofs.stimuli import GOOD, NOTHING, WORD, Answer, mutant, run
from railgate.position_link.proofs.supervised import Supervised
from railgate.position_link.spec import Config, Health, Status
from railgate.proving import Claim, Induction

__all__ = ["CLAIMS"]

DEFAULT = Config()
CAUTIOUS = Config(tolerated_cycles=2, recovery_cycles=3)
ONES = Answer(DEFAULT.invalid_word)
GARBAGE = Answer(WORD ^ 0xFF, bits=40)


class _FaultWord(Supervised):
    """The fault word after `tolerated_cycles` faulty cycles in a row or where none was good yet."""

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.link(m)
        due = (self.faulty_run >= self.config.tolerated_cycles) | ~self.ever_good
        m.d.comb += [
            self.holds.eq(
                ((inner["status"] == Status.FAULT) == due)
                & ((inner["word"] == self.config.invalid_word) == due)
            ),
            self.reached.eq(due & self.ever_good),
        ]
        return m


class _Recovery(Supervised):
    """Once down, down until `recovery_cycles` good cycles in a row; and the other way round."""

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.link(m)
        m.d.comb += [
            self.holds.eq(
                ((inner["status"] == Status.FAULT) == self.down)
                & ((inner["word"] == self.config.invalid_word) == self.down)
            ),
            self.reached.eq(~self.down),
        ]
        return m


class _Valid(Supervised):
    """The status alone tells the fault word from a position."""

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.link(m)
        fault = inner["status"] == Status.FAULT
        known = fault | (inner["status"] == Status.HELD) | (inner["status"] == Status.FRESH)
        m.d.comb += [
            self.holds.eq(known & ((inner["word"] == self.config.invalid_word) == fault)),
            self.reached.eq(~fault),
        ]
        return m


class _Held(Supervised):
    """A held word is the last good cycle's, marked with its age, and not older than tolerated."""

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.link(m)
        status, age = inner["status"], inner["age"]
        held = status == Status.HELD
        never = (1 << self.config.age_bits) - 1
        oldest = Mux(self.faulty_run > never, never, self.faulty_run)
        m.d.comb += [
            self.holds.eq(
                (~held | ((inner["word"] == self.last) & (age < self.config.tolerated_cycles)))
                & (age == Mux(self.ever_good, oldest, never))
                & ((status != Status.FRESH) | (age == 0))
                & (~held | (age != 0))
            ),
            self.reached.eq(held & (age == self.config.tolerated_cycles - 1)),
        ]
        return m


class _Health(Supervised):
    """Warning at the first faulty cycle, alarm with the fault word, but for the very first ones."""

    def __init__(self, config: Config) -> None:
        super().__init__(config, ("start",))

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.link(m)
        up = Mux(self.good, Health.OK, Health.WARNING)
        down = Mux(self.good, Health.RECOVERING, Health.ALARM)
        starts = ~self.ever_good & (self.faulty_run < self.config.tolerated_cycles)
        m.d.comb += [
            self.lemma.start.eq(~starts | (inner["number"] == self.faulty_run)),
            self.holds.eq(inner["health"] == Mux(self.down, Mux(starts, Health.START, down), up)),
            self.reached.eq(inner["health"] == Health.ALARM),
        ]
        return m


CLAIMS = (
    Claim(
        name="position_link.fault-word",
        claim=(
            "For ever, the word is the fault word and its status FAULT if and only if the last "
            "three cycles or more were faulty, or no cycle was good since reset (default "
            "configuration: tolerated_cycles = 3, recovery_cycles = 1)."
        ),
        requirements=("LNK-5",),
        monitor=partial(_FaultWord, DEFAULT),
        method=Induction(),
        cover=run(DEFAULT, [GOOD], NOTHING, NOTHING, NOTHING),
        mutants=(
            mutant(
                "one-more",
                "supervision",
                "Mux(up, tolerated - 1,",
                "Mux(up, tolerated,",
                run(DEFAULT, [GOOD], NOTHING, NOTHING, NOTHING),
            ),
            mutant(
                "one-less",
                "supervision",
                "Mux(up, tolerated - 1,",
                "Mux(up, tolerated - 2,",
                run(DEFAULT, [GOOD], NOTHING, NOTHING),
            ),
            mutant(
                "not-in-a-row",
                "supervision",
                "Mux(longer, run + 1, 0)",
                "Mux(longer, run + 1, run)",
                run(DEFAULT, [GOOD], NOTHING, [GOOD], NOTHING, NOTHING),
            ),
            mutant(
                "never-down",
                "supervision",
                "up_next.eq(up ^ turns)",
                "up_next.eq(up | turns)",
                run(DEFAULT, [GOOD], NOTHING, NOTHING, NOTHING),
            ),
        ),
        fast=False,
    ),
    Claim(
        name="position_link.recovery",
        claim=(
            "For ever, the fault word is there from the start on and from the second faulty cycle "
            "in a row on, in each case until the third good cycle in a row, and at no other time "
            "(default configuration, but tolerated_cycles = 2, recovery_cycles = 3)."
        ),
        requirements=("LNK-5",),
        monitor=partial(_Recovery, CAUTIOUS),
        method=Induction(),
        cover=run(CAUTIOUS, [GOOD], [GOOD], [GOOD]),
        mutants=(
            mutant(
                "two-will-do",
                "supervision",
                "recovery - 1)),",
                "recovery - 2)),",
                run(CAUTIOUS, [GOOD], [GOOD]),
            ),
            mutant(
                "not-in-a-row",
                "supervision",
                "Mux(longer, run + 1, 0)",
                "Mux(longer, run + 1, run)",
                run(CAUTIOUS, [GOOD], NOTHING, [GOOD], [GOOD]),
            ),
            mutant(
                "run-goes-on",
                "supervision",
                "longer.eq(against & ~turns)",
                "longer.eq(against)",
                run(CAUTIOUS, [GOOD], [GOOD], [GOOD], NOTHING, NOTHING),
            ),
        ),
        fast=False,
    ),
    Claim(
        name="position_link.valid",
        claim=(
            "For ever, a word with the status FRESH or HELD is never the fault word, and with the "
            "status FAULT it is nothing else; there is no other status (default configuration)."
        ),
        requirements=("LNK-5",),
        monitor=partial(_Valid, DEFAULT),
        method=Induction(),
        cover=run(DEFAULT, [GOOD]),
        mutants=(
            mutant(
                "zeros-compared",
                "verdict",
                "self.word ^ config.invalid_word,",
                "self.word,",
                run(DEFAULT, [ONES]),
            ),
            mutant(
                "verdict-without-it",
                "verdict",
                "of_word = Cat(check_fails, is_fault_word, is_zero)",
                "of_word = Cat(check_fails, is_zero)",
                run(DEFAULT, [ONES]),
            ),
            mutant(
                "keeps-the-word",
                "supervision",
                "self.settled & (self.good | ~up_next)",
                "self.settled & self.good & up_next",
                run(DEFAULT, [GOOD], NOTHING, NOTHING, NOTHING),
            ),
        ),
        fast=False,
    ),
    Claim(
        name="position_link.held",
        claim=(
            "For ever, a word delivered as HELD is the word of the last good cycle, 1 or 2 cycles "
            "old; age is the number of cycles since the last good one, 63 at most and where there "
            "was none, and 0 with FRESH (default configuration: tolerated_cycles = 3)."
        ),
        requirements=("LNK-5", "LNK-6"),
        monitor=partial(_Held, DEFAULT),
        method=Induction(),
        cover=run(DEFAULT, [GOOD], NOTHING, NOTHING),
        mutants=(
            mutant(
                "without-limit",
                "supervision",
                "turns = against & last",
                "turns = against & ~up & last",
                run(DEFAULT, [GOOD], NOTHING, NOTHING, NOTHING),
            ),
            mutant(
                "what-came",
                "supervision",
                "self.settled & (self.good | ~up_next)",
                "self.settled",
                run(DEFAULT, [GOOD], [GARBAGE]),
            ),
            mutant(
                "age-stays",
                "supervision",
                "older.eq(self.age + grows)",
                "older.eq(self.age)",
                run(DEFAULT, [GOOD], NOTHING),
            ),
        ),
        fast=False,
    ),
    Claim(
        name="position_link.health",
        claim=(
            "For ever, the health is WARNING with the first faulty cycle while the link is up, "
            "ALARM with every one while it is down, RECOVERING with good ones there, OK with good "
            "ones while it is up, and START as long as since reset there were only faulty ones, "
            "fewer than tolerated_cycles "
            "(default configuration, but tolerated_cycles = 2, recovery_cycles = 3)."
        ),
        requirements=("LNK-5", "LNK-7"),
        monitor=partial(_Health, CAUTIOUS),
        method=Induction(),
        cover=run(CAUTIOUS, [GOOD], NOTHING),
        mutants=(
            mutant(
                "alarm-at-start",
                "supervision",
                "Mux(starts, Health.START, Health.ALARM)",
                "Health.ALARM",
                run(CAUTIOUS, NOTHING),
            ),
            mutant(
                "dead-without-alarm",
                "supervision",
                "(self.health == Health.START) & ~first_turn",
                "self.health == Health.START",
                run(CAUTIOUS, NOTHING, NOTHING, NOTHING),
            ),
            mutant(
                "alarm-stays",
                "supervision",
                "Mux(self.good, Health.RECOVERING,",
                "Mux(self.good, self.health,",
                run(CAUTIOUS, [GOOD]),
            ),
            mutant(
                "without-warning",
                "supervision",
                "Mux(self.good, Health.OK, Health.WARNING)",
                "Mux(self.good, Health.OK, Health.OK)",
                run(CAUTIOUS, [GOOD], [GOOD], [GOOD], NOTHING),
            ),
        ),
        fast=False,
    ),
)
