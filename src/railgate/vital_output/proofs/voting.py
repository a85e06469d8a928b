"""The vote: what passes came from both CPUs, the same in all fields, inside τ0; what is stored has
passed in both FPGAs."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal, Value

from railgate.proving import Claim, Induction, Internals, Monitor, Mutant, Run, Search
from railgate.vital_output.proofs.stimuli import SEARCH, Step, mutant, trace
from railgate.vital_output.spec import Config
from railgate.waves import Trace

__all__ = ["CLAIMS"]

DEFAULT = Config()
TAU0 = DEFAULT.tau0_ticks
EVENTS = ("accepted", "peer_accepted", "peer_ok", "peer_passed", "peer_carries", "decides")
NUMBERS = ("crc", "peer_sequence", "decided")
FRAMES = ("own", "forwarded")
PARTS = {"numbers": 64, "bits": 2 * DEFAULT.outputs}
"""Of a frame: index and sequence; image and acknowledge."""
INPUTS = {
    **dict.fromkeys(EVENTS, 1),
    **dict.fromkeys(NUMBERS, 32),
    **{f"{frame}_{part}": width for frame in FRAMES for part, width in PARTS.items()},
}


class _Vote(Monitor):
    """The vote, and what the contract makes of its inputs; ages of both frames beside it."""

    def __init__(self) -> None:
        super().__init__(INPUTS, ("sound", "slots", "window", "ages"))

    def elaborate(self, _platform: object) -> Module:
        from railgate.vital_output.gateware.vote import Vote

        m = Module()
        m.submodules.dut = inner = Internals(dut := Vote(DEFAULT))
        m.d.comb += [getattr(dut, name).eq(getattr(self, name)) for name in (*EVENTS, *NUMBERS)]
        m.d.comb += [
            getattr(dut, f"{name}_frame").as_value().eq(self._frame(name)) for name in FRAMES
        ]

        frame = dut.own.shape()
        own, forwarded = Signal(frame, name="own"), Signal(frame, name="forwarded")
        own_there, own_age = self._slot(m, "own", self.accepted, own)
        forwarded_there, forwarded_age = self._slot(m, "forwarded", self.peer_accepted, forwarded)
        window = Signal(range(TAU0 + 1))  # ticks since the first of them came, 0 without one

        both = own_there & forwarded_there
        same = own.as_value() == forwarded.as_value()
        closes = ~both & (window == TAU0)
        with m.If((both | closes) & ~self.accepted):
            m.d.sync += own_there.eq(0)
        with m.If((both | closes) & ~self.peer_accepted):
            m.d.sync += forwarded_there.eq(0)
        with m.If(both | closes | (window == 0)):
            m.d.sync += window.eq(self.accepted | self.peer_accepted)
        with m.Else():
            m.d.sync += window.eq(window + 1)

        passed, waits, carries = (Signal(name=name) for name in ("passed", "waits", "carries"))
        told = self.peer_ok & self.peer_carries & self.peer_passed
        stored = waits & told & (self.peer_sequence == own.sequence)
        over = self.decides & ((own.index - self.decided)[:32].as_signed() <= 0)
        m.d.sync += [
            passed.eq((passed | (both & same)) & ~self.accepted),
            waits.eq(((waits & ~stored) | (both & same)) & ~over & ~self.accepted),
            carries.eq(carries | self.accepted),
        ]

        later = own_age > forwarded_age
        apart = Mux(later, own_age - forwarded_age, forwarded_age - own_age)
        expected = {
            "passes": both & same,
            "mismatch": both & ~same,
            "skew": closes & (own_there | forwarded_there),
            "stored": stored,
            "passed": passed,
            "carries": carries,
        }
        m.d.comb += [
            self.lemma.sound.eq(~dut.error),
            self.lemma.slots.eq(
                (inner["own_there"] == own_there)
                & (inner["forwarded_there"] == forwarded_there)
                & (inner["forwarded"] == forwarded.as_value())
                & (inner["open"] == waits)
                & (~waits | (passed & ~own_there))
                & (~(own_there | passed) | carries)
            ),
            self.lemma.window.eq(
                (inner["held_remaining.value"] == Mux(window == 0, 0, TAU0 + 1 - window))
                & (window <= TAU0)
                & ((window != 0) | ~(own_there | forwarded_there))
            ),
            self.lemma.ages.eq(
                (~own_there | ((own_age <= window) & (own_age != 0)))
                & (~forwarded_there | ((forwarded_age <= window) & (forwarded_age != 0)))
            ),
            self.holds.eq(
                Cat(*(inner[name] == value for name, value in expected.items())).all()
                & (dut.own.as_value() == own.as_value())
                & (~dut.passes | (apart < TAU0))
                & (~dut.stored | (passed & carries))
            ),
            self.reached.eq(dut.passes & (apart == TAU0 - 1)),
        ]
        return m

    def _frame(self, name: str) -> Value:
        return Cat(getattr(self, f"{name}_{part}") for part in PARTS)

    def _slot(self, m: Module, name: str, filled: Value, slot: Signal) -> tuple[Signal, Signal]:
        """Keeps the frame that fills it: whether it waits, and ticks since it came."""
        there, age = Signal(name=f"{name}_there"), Signal(range(TAU0 + 2), name=f"{name}_age")
        m.d.sync += age.eq(age + (age != TAU0 + 1))
        with m.If(filled):
            m.d.sync += [slot.as_value().eq(self._frame(name)), there.eq(1), age.eq(1)]
        return there, age


def _skews() -> Trace:
    """Frames that are just inside τ0, and just beyond it; either one first."""
    own, peers, both = {"accepted": 1}, {"peer_accepted": 1}, {"accepted": 1, "peer_accepted": 1}
    other = {"accepted": 1, "own_bits": 1}
    rest: Step = (TAU0 + 2, {})
    steps: tuple[Step, ...] = (
        *((1, own), (TAU0 - 2, {}), (1, peers), rest),
        *((1, own), (TAU0 - 1, {}), (1, peers), rest),
        *((1, peers), (TAU0 - 1, {}), (1, own), rest),
        *((1, both), rest, (1, own), (2, {}), (1, other), (TAU0 - 4, {}), (1, peers), rest),
    )
    return trace(INPUTS, steps)


SKEWS = Run(_skews().end, _skews)


def _mutant(name: str, old: str, new: str, rejected: Search | Run = SEARCH) -> Mutant:
    return mutant(name, "vote", old, new, rejected)


CLAIMS = (
    Claim(
        name="vital_output.vote",
        claim=(
            "For ever, a vote passes just where a frame of each CPU waits, accepted less than "
            "tau0_ticks apart, equal in index, sequence, image and acknowledge; where they differ "
            "or one is alone nothing passes; and a frame is stored just where it has passed here, "
            "its cycle is not decided yet, and the peer's last message tells that it has passed "
            "the same sequence there (default configuration)."
        ),
        requirements=("DRV-6",),
        monitor=_Vote,
        fast=False,
        method=Induction(),
        cover=SKEWS,
        mutants=(
            _mutant(
                "acknowledge-ignored",
                "same = self.own.as_value() == forwarded.as_value()",
                "same = self.own.as_value()[:80] == forwarded.as_value()[:80]",
            ),
            _mutant(
                "index-ignored",
                "same = self.own.as_value() == forwarded.as_value()",
                "same = self.own.as_value()[32:] == forwarded.as_value()[32:]",
            ),
            _mutant(
                "window-a-tick-longer", "Mux(fills, tau0, 0)", "Mux(fills, tau0 + 1, 0)", SKEWS
            ),
            _mutant(
                "window-begins-anew",
                "over = both | closes | (remaining.value == 0)",
                "over = both | closes | (remaining.value == 0) | fills",
                SKEWS,
            ),
            _mutant("stored-alone", "& self.peer_passed\n", "\n"),
            _mutant(
                "stored-after-decision",
                "(self.decides & (ahead <= 0))",
                "(self.decides & (ahead < 0))",
            ),
            _mutant(
                "passed-stays",
                "m.d.sync += [self.passed.eq(0), open_.eq(0)]",
                "m.d.sync += open_.eq(0)",
            ),
        ),
    ),
)
