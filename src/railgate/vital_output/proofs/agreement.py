"""A channel drives by a live command alone, and a command lives that both CPUs have sent."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from amaranth.hdl import Cat, Module, Mux, Signal, Value

from railgate.proving import Claim, Induction, Internals, Run, Search
from railgate.vital_output.proofs.cut import Told
from railgate.vital_output.proofs.free import Free, widths
from railgate.vital_output.proofs.stimuli import Step, mutant, trace, train
from railgate.vital_output.spec import Code, Config, State, TestPhase
from railgate.waves import Trace

__all__ = ["CLAIMS"]

TWO = Config(outputs=2)
QUIET = (State.IDLE, State.HANDSHAKE_ALARM, State.FEEDBACK_ALARM)


class _Decided(Free):
    """Time is cut out too: cycles are decided at any time."""

    def __init__(self, board: int, *lemmas: str) -> None:
        super().__init__(TWO, board, {"decides": 1, "index": 32}, ("sound", *lemmas))

    def told(self) -> Told:
        return {
            **super().told(),
            "Timekeeper": {"index": self.index, "decides": self.decides},
        }

    def among(self, inner: Internals, *states: State) -> Value:
        """The outputs that are in one of these states."""
        return Cat(
            Cat(inner[f"output_{number}.state"] == state for state in states).any()
            for number in range(self.config.outputs)
        )


class _Agreed(_Decided):
    """Pulses come from DRIVE or TEST; DRIVE from an image bit with life; both from agreement."""

    def __init__(self) -> None:
        super().__init__(0, "frames", "driven", "live")

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.channel(m)
        n, life, image = self.config.outputs, inner["life"], inner["image"]
        own, forwarded = self.own_frame(), self.forwarded_frame()
        own_last, forwarded_last = Signal.like(own), Signal.like(forwarded)
        forwarded_any, voted = Signal(), Signal()
        with m.If(self.accepted):
            m.d.sync += own_last.eq(own)
        with m.If(self.forwarded):
            m.d.sync += [forwarded_last.eq(forwarded), forwarded_any.eq(1)]
        same = forwarded_any & (own_last == forwarded_last)
        m.d.sync += voted.eq((voted | same) & ~self.accepted)
        told = self.peer_ok & self.peer_passed & self.peer_carries
        agreed = voted & told & (self.peer_sequence == own_last[32:64])

        drives = self.among(inner, State.DRIVE)
        was_life, was_image, was_agreed = Signal.like(life), Signal(n), Signal()
        ones, commanded, drove, tested = (Signal(n) for _ in range(4))
        m.d.sync += [
            was_life.eq(life),
            was_image.eq(image),
            was_agreed.eq(agreed),
            ones.eq(Mux(agreed, own_last[64 : 64 + n], 0)),
            commanded.eq(Mux(life != 0, image, 0)),
            drove.eq(drives & commanded),
            tested.eq(self.among(inner, State.TEST)),
        ]
        m.d.comb += [
            self.lemma.frames.eq(
                (Value.cast(inner["vote.own"]) == own_last)
                & (Value.cast(inner["vote.forwarded"]) == forwarded_last)
                & (~inner["vote.forwarded_there"] | forwarded_any)
                & (~inner["vote.open"] | voted)
            ),
            self.lemma.driven.eq(~(drives & ~commanded).any()),
            self.lemma.live.eq((life != 0) | ~image.any()),
            self.holds.eq(
                ((life <= was_life) | was_agreed)
                & ~(image & ~was_image & ~ones).any()
                & ((life != 0) | ~image.any())
                & ~(inner["pulses"] & ~drove & ~tested).any()
            ),
            self.reached.eq((inner["pulses"] & drove).any()),
        ]
        return m


class _Started(_Decided):
    """DRIVE is for what has been 0 since the start, both tests done; a test is made alone."""

    def __init__(self, board: int) -> None:
        super().__init__(board, "cleared", "tests")

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.channel(m)
        phase = inner["test_phase"]
        drives = self.among(inner, State.DRIVE)
        tests = self.among(inner, State.TEST)
        quiet = self.among(inner, *QUIET).all()
        cleared, ready, tested = (Signal(self.config.outputs) for _ in range(3))
        may_begin = Signal()
        done, peer_done = (
            (told == TestPhase.DONE) | (told == TestPhase.REQUESTED)
            for told in (phase, self.peer_test)
        )
        peers_turn = peer_done if self.board else self.peer_test == TestPhase.WANTED
        zeros = Mux(inner["life"] != 0, ~inner["image"], 0)
        m.d.sync += [
            cleared.eq(Mux(self.booted, 0, cleared | zeros)),
            ready.eq(Mux(done & peer_done, cleared, 0)),
            tested.eq(tests),
            may_begin.eq(quiet & self.peer_ok & (phase == TestPhase.WANTED) & peers_turn),
        ]
        driven = self.among(inner, State.PRE_DRIVE, State.DRIVE)
        entered = tests & ~tested
        m.d.comb += [
            self.lemma.cleared.eq(~inner["blocked"] == cleared),
            self.lemma.tests.eq(~tests.any() | (phase == TestPhase.RUNNING)),
            self.holds.eq(
                ~(drives & ~ready).any()
                & (~entered.any() | may_begin)
                & ~(tests.any() & driven.any())
            ),
            self.reached.eq(drives.any()),
        ]
        return m


def _switched_on(board: int) -> Trace:
    """Commands before the shut-off test; the test with its feedback; a 1 that has not been 0; a 0,
    a 1 and drive, which ends with the life; drive anew, which ends with the peer's start."""
    config = TWO
    peer = {"peer_ok": 1, "peer_passed": 1, "peer_carries": 1}
    testing, done = peer | {"peer_test": TestPhase.RUNNING}, peer | {"peer_test": TestPhase.DONE}
    both, one = {"accepted": 1, "forwarded": 1}, {"image": 1, "peer_image": 1}
    codes, over = {"peer_codes": Code.DRIVE}, {"decides": 1, "index": 5}

    def voted(beside: Mapping[str, int], image: Mapping[str, int]) -> tuple[Step, Step]:
        return (1, {**beside, **image, **both}), (8, {**beside, **codes})

    turn = peer | {"peer_test": TestPhase.DONE if board else TestPhase.WANTED}
    periods = config.test_ticks // config.period_ticks + 2
    steps: tuple[Step, ...] = (
        *(*voted(testing, {}), *voted(testing, one), (1, testing | {"booted": 1})),
        (config.life_cycles, testing | over),
        *train(config.period_ticks, periods, "pulse_feedback", turn),
        (2 * config.zero_ticks, done),
        *(*voted(done, one), *voted(done, {}), *voted(done, one)),
        *((config.life_cycles, done | codes | over), (8, done | codes)),
        *(*voted(done, one), (1, done | codes | {"booted": 1}), (8, done | codes)),
    )
    return trace(widths(TWO) | {"decides": 1, "index": 32}, steps)


SWITCHED_ON = tuple(Run(_switched_on(board).end, partial(_switched_on, board)) for board in (0, 1))
AGREED = Search(6)

CLAIMS = (
    Claim(
        name="vital_output.agreed",
        claim=(
            "For ever and whatever the CPU, the peer, the time and the feedback tell, an output "
            "pulses only after TEST, or after DRIVE with a life and an image bit of 1; and a life "
            "grows, or an image bit becomes 1, only in the tick after one in which the frame last "
            "accepted has been found equal to a forwarded one and the peer tells that it has "
            "passed there too (a channel of 2 outputs, else of the default configuration, with "
            "command, checks, link and time cut out and free)."
        ),
        requirements=("DRV-6", "DRV-7"),
        monitor=_Agreed,
        fast=False,
        method=Induction(2),
        cover=SWITCHED_ON[0],
        mutants=(
            mutant(
                "vote-of-one",
                "vote",
                "self.passes.eq(both & same)",
                "self.passes.eq(own_there & same)",
                AGREED,
            ),
            mutant("unpassed-peer", "vote", "                & self.peer_passed\n", "", AGREED),
            mutant(
                "image-of-the-peer",
                "vote",
                "same = self.own.as_value() == forwarded.as_value()",
                "same = self.own.sequence == forwarded.sequence",
                AGREED,
            ),
            mutant(
                "life-from-frames",
                "storage",
                "life.next.eq(self._config.life_cycles)",
                "life.next.eq(self._config.life_cycles)\n        "
                "with m.Elif(self.accepted):\n            m.d.comb += life.next.eq(1)",
                AGREED,
            ),
            mutant(
                "image-outlives",
                "storage",
                "with m.If(~(self.life_out | self.upset | latched_next)):",
                "with m.If(~(self.upset | latched_next)):",
                Search(10),
            ),
            mutant(
                "pulses-in-pre-drive",
                "output",
                "(state.value == State.DRIVE)",
                "((state.value == State.DRIVE) | (state.value == State.PRE_DRIVE))",
                SWITCHED_ON[0],
            ),
            mutant(
                "stays-in-drive",
                "output",
                "with m.Case(State.DRIVE):\n                with m.If(~self.cmd):",
                "with m.Case(State.DRIVE):\n                with m.If(~self.cmd & self.frequency):",
                SWITCHED_ON[0],
            ),
        ),
    ),
    *(
        Claim(
            name=f"vital_output.start-{board + 1}",
            claim=(
                f"For ever and whatever comes in, FPGA {board + 1} drives an output only after its "
                "image bit has been 0 with a life since the last start of either FPGA, and while "
                "both have made their tests; a test begins only with all outputs quiet, the peer's "
                "clock and link good, and in its turn, and no output drives or prepares to while "
                "one tests (2 outputs, else default configuration, cut as in vital_output.agreed)."
            ),
            requirements=("DRV-5", "DRV-18"),
            monitor=partial(_Started, board),
            fast=False,
            method=Induction(),
            cover=SWITCHED_ON[board],
            mutants=(
                mutant(
                    "start-unblocked",
                    "storage",
                    "with m.If(self.booted):",
                    "with m.If(self.booted & self.stored):",
                    SWITCHED_ON[board],
                ),
                mutant(
                    "zero-without-life",
                    "storage",
                    "with m.Elif((life.value != 0) & ~self.upset):",
                    "with m.Elif(~self.upset):",
                    SWITCHED_ON[board],
                ),
                mutant(
                    "drives-untested",
                    "channel",
                    "drives = ~upset & shutoff.both_done",
                    "drives = ~upset",
                    SWITCHED_ON[board],
                ),
                mutant(
                    "tests-beside-drive",
                    "shutoff",
                    "wanted & quiet & self.peer_ok & in_turn",
                    "wanted & self.peer_ok & in_turn",
                ),
                mutant(
                    "tests-out-of-turn",
                    "shutoff",
                    "wanted & quiet & self.peer_ok & in_turn",
                    "wanted & quiet & self.peer_ok",
                ),
            ),
        )
        for board in (0, 1)
    ),
)
