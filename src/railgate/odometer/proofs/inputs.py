"""The filter of an input: what passes it, and when."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal, Value

from railgate.proving import Claim, Induction, Internals, Monitor, Mutant

__all__ = ["CLAIMS"]

FILTER_TICKS = 3
SEATED = 3
"""The tick from which the level at start is the output."""
LATE = SEATED + FILTER_TICKS
"""`input_delay_ticks` of these FILTER_TICKS."""


class _Filtered(Monitor):
    """A filter with the past of its pin, x[k - 1], x[k - 2], …, and of its level beside it."""

    def __init__(self) -> None:
        super().__init__({"pin": 1}, lemmas=("delays", "seats", "remembers", "counts"))
        self.past = Signal(LATE + 1)
        self.before = Signal()
        self.tick = Signal(range(LATE + 2))

    def x(self, ticks_ago: int) -> Value:
        """The pin so many ticks ago, at least 1."""
        return self.past[ticks_ago - 1]

    def filtered(self, m: Module) -> Internals:
        """Adds the filter, the past, and what binds the one to the other."""
        from railgate.primitives import FilteredInput

        dut = FilteredInput(FILTER_TICKS)
        m.submodules.dut = inner = Internals(dut)
        m.d.comb += dut.pin.eq(self.pin)
        m.d.sync += [
            self.past.eq(Cat(self.pin, self.past)),
            self.before.eq(dut.level),
            self.tick.eq(Mux(self.tick == LATE + 1, self.tick, self.tick + 1)),
        ]

        held, level = inner["held"], inner["level"]
        other = [self.x(3 + ago) != level for ago in range(FILTER_TICKS + 1)]
        runs = [
            (held == n) & (self.tick >= SEATED + n) & Cat(*other[:n]).all() & ~other[n]
            for n in range(FILTER_TICKS + 1)
        ]
        edge = (self.tick > SEATED) & (level != self.before)
        stages = Cat(inner["synchroniser.stage0"], inner["synchroniser.stage1"])
        m.d.comb += [
            self.lemma.delays.eq(stages == self.past[:2]),
            self.lemma.seats.eq(
                (inner["seats"] == (1 << self.tick)[:SEATED])
                & ((self.tick > 1) | ((self.past >> self.tick)[:2] == 0))
            ),
            self.lemma.remembers.eq(
                (inner["rise"] == (edge & level))
                & (inner["fall"] == (edge & self.before))
                & (inner["full"] == ((held == FILTER_TICKS) | (self.tick == SEATED - 1)))
            ),
            self.lemma.counts.eq(Mux(self.tick < SEATED, (held == 0) & ~level, Cat(*runs).any())),
        ]
        return inner


class _Rejects(_Filtered):
    """A new level was held for longer than FILTER_TICKS; one that was not is told as a glitch."""

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.filtered(m)
        level, told = inner["level"], self.tick > SEATED
        new = told & (level != self.before)
        held = Cat(*(self.x(3 + ago) == level for ago in range(FILTER_TICKS + 1))).all()
        gone = told & ~new & (self.x(2) == level) & (self.x(3) != self.before)
        m.d.comb += [
            self.holds.eq((~new | held) & (inner["glitch"] == gone)),
            self.reached.eq(gone & level),
        ]
        return m


class _Delays(_Filtered):
    """A change of the pin to a level that stays is an edge, and so late is every edge."""

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.filtered(m)
        level = inner["level"]
        stays = Cat(*(self.x(3 + ago) == self.x(3) for ago in range(FILTER_TICKS + 1))).all()
        due = (self.tick > LATE) & stays & (self.x(LATE + 1) != self.x(LATE))
        edge = (self.tick > SEATED) & (level != self.before)
        m.d.comb += [
            self.holds.eq(
                (~due | (level == self.x(LATE)))
                & (~edge | due)
                & (inner["rise"] == (edge & level))
                & (inner["fall"] == (edge & ~level))
            ),
            self.reached.eq(inner["fall"]),
        ]
        return m


def _mutant(name: str, old: str, new: str) -> Mutant:
    return Mutant(name, "railgate.primitives.inputs", old, new)


CLAIMS = (
    Claim(
        name="odometer.inputs-reject",
        claim=(
            f"With filter_ticks = {FILTER_TICKS}, no level that a pin holds for at most "
            f"{FILTER_TICKS} ticks passes, and each is told as one glitch when it has gone."
        ),
        requirements=("ODO-9",),
        monitor=_Rejects,
        method=Induction(),
        mutants=(
            _mutant(
                "a-tick-short", "held == self._filter_ticks - 1)", "held == self._filter_ticks - 2)"
            ),
            _mutant(
                "adds-up-glitches",
                "(held + 1) & counts.replicate(len(held))",
                "held + counts",
            ),
            _mutant("short-glitch-untold", "(held != 0)", "(held > 1)"),
        ),
    ),
    Claim(
        name="odometer.inputs-delay",
        claim=(
            f"With filter_ticks = {FILTER_TICKS}, a pin's change to a level that it holds for more "
            f"than {FILTER_TICKS} ticks is an edge {LATE} ticks later, rising and falling alike, "
            "and there is no other edge."
        ),
        requirements=("ODO-9",),
        monitor=_Delays,
        method=Induction(),
        mutants=(
            _mutant("a-stage-more", "STAGES = 2", "STAGES = 3"),
            _mutant(
                "falls-sooner",
                "held == self._filter_ticks - 1)",
                "held == self._filter_ticks - 1 - self.level)",
            ),
            _mutant("edge-at-start", "passes & synchronised & ~seats[-1]", "passes & synchronised"),
        ),
    ),
)
