"""A frame's check: good only where this very check has seen its comparator agree and disagree."""

from __future__ import annotations

from collections.abc import Iterable
from functools import reduce
from operator import or_
from unittest.mock import patch

from amaranth.hdl import Array, Cat, Const, Elaboratable, Module, Mux, Signal, Value
from amaranth.lib.crc import Processor

from railgate.proving import Claim, Induction, Internals, Monitor, Mutant, Run
from railgate.vital_output.proofs.stimuli import Step, mutant, trace
from railgate.vital_output.spec import Cause, Config
from railgate.waves import Trace

__all__ = ["CLAIMS"]

CONFIG = Config()
IMPLICIT = CONFIG.layout.implicit_bytes
COVERED = IMPLICIT + CONFIG.layout.frame_bytes - 4
TRIED = CONFIG.delay_cycles + 2
RUNS = 2 * TRIED + 1
COMPARED, KEPT, SETTLED = 1, 3, CONFIG.check_overhead_ticks - 1
"""Ticks after a run's end in which its CRC is compared, the result is kept, all is at rest."""
FIELDS = {"sequence": 32, "image": CONFIG.outputs, "acknowledge": CONFIG.outputs}
INPUTS = {
    **FIELDS,
    "crc": 32,
    "malformed": 1,
    "start": 1,
    "index": 32,
    "trusted": 1,
    "phase": (CONFIG.cycle_ticks + CONFIG.slew_ticks - 1).bit_length(),
    "wrong": 32,
}


class _Table:
    """An Array as plain logic: Yosys makes a memory of one of constants, and what is in a memory an
    induction takes for free."""

    def __init__(self, values: Iterable[Value]) -> None:
        self._values = tuple(values)

    def __getitem__(self, index: Value) -> Value:
        return reduce(or_, (Mux(index == n, value, 0) for n, value in enumerate(self._values)))


class _Wrong(Elaboratable):
    """A CRC engine of whose result these bits are wrong."""

    def __init__(self, engine: Processor, wrong: Value) -> None:
        self._engine, self._wrong = engine, wrong
        self.start, self.data, self.valid = engine.start, engine.data, engine.valid
        self.crc = Signal.like(engine.crc)

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.submodules.engine = self._engine
        m.d.comb += self.crc.eq(self._engine.crc ^ self._wrong)
        return m


class _Check(Monitor):
    """Bytes, comparisons and verdict of a check as the contract has them.

    wrong: in, 32 bits, of the CRC that the comparator sees these are wrong: so it may tell anything
    at any time. Assumed is that a check begins only when there is none.
    """

    def __init__(self) -> None:
        super().__init__(INPUTS, ("times", "feeds", "compares"))
        self.left = Signal(range(CONFIG.check_ticks + 1))  # ticks of the check with this one
        self.run, self.at = Signal(range(RUNS + 1), init=RUNS), Signal(range(COVERED), init=SETTLED)
        self.index_0, self.wanted = Signal(32), Signal(32)
        self.fields = Signal(8 * (COVERED - IMPLICIT))
        self.equal = Signal(RUNS)  # the comparisons of this check
        self.early, self.late = Signal(), Signal()
        self.trusted_0, self.malformed_0 = Signal(), Signal()

    def elaborate(self, _platform: object) -> Module:
        from railgate.vital_output.gateware import check

        wrong = self.wrong

        class Faulty(check.FrameCheck):
            def _processor(self) -> _Wrong:
                return _Wrong(super()._processor(), wrong)

        m = Module()
        with patch.object(check, "Array", _Table):
            inner = Internals(dut := Faulty(CONFIG, 0, CONFIG.margin_ticks))
        m.submodules.dut = inner
        for name in (*FIELDS, "crc", "malformed"):
            m.d.comb += getattr(dut.frame, name).eq(getattr(self, name))
        for name in ("start", "index", "phase", "trusted"):
            m.d.comb += getattr(dut, name).eq(getattr(self, name))
        self._times(m)

        index = (self.index_0 + 1 - self.equal[1] - 2 * self.equal[2])[:32]
        acceptable = (self.equal[0] & self.early) | self.equal[1] | (self.equal[2] & self.late)
        board, time = self._tried(index)
        byte, first, feeds = Signal(8), Signal(), Signal()
        told = Cat(self.fields, time, board)
        m.d.sync += [
            byte.eq(Array(told[8 * n : 8 * n + 8] for n in reversed(range(COVERED)))[self.at]),
            first.eq(self.at == 0),
            feeds.eq(self.run != RUNS),
        ]
        crc = inner["crc.crc"]
        with m.If(self.start):
            m.d.sync += self.equal.eq(0)
        with m.Elif((self.run != 0) & (self.at == COMPARED)):
            m.d.sync += self.equal.bit_select((self.run - 1)[: len(self.run)], 1).eq(
                crc == self.wanted
            )
        newest = Mux(
            (self.run != 0) & (self.at == COMPARED + 1), Const(1, RUNS) << (self.run - 1)[:4], 0
        )

        own, other = self.equal[:TRIED], self.equal[TRIED : 2 * TRIED]
        verdict = Mux(
            acceptable,
            Mux(self.equal[-1], Cause.COMPARATOR, Cause.NONE),
            Mux(own.any(), Cause.DELAY, Mux(other.any(), Cause.MASQUERADE, Cause.CORRUPTION)),
        )
        cause = Mux(self.malformed_0, Cause.FORMAT, Mux(self.trusted_0, verdict, Cause.TIME))
        good = self.left == 1
        busy = self.left != 0
        m.d.comb += [
            self.assumed.eq(~(self.start & (self.left > 1))),
            self.lemma.times.eq(
                (inner["until_done.remaining"] == self.left)
                & (inner["until_done.active"] == busy)
                & (self.left == Mux(busy, CONFIG.check_ticks - self.run * COVERED - self.at, 0))
                & (self.at < COVERED)
                & (inner["run"] == self.run)
                & (inner["at"] == Mux(self.run == RUNS, 0, self.at))
                & (busy | ((self.run == RUNS) & (self.at == SETTLED)))
                & ((self.run != RUNS) | (self.at <= SETTLED))
                & (
                    inner["whole"]
                    == Cat((self.run != 0) & (self.at == 0), (self.run != 0) & (self.at == 1))
                )
                & (inner["judges"] == ((self.run != 0) & (self.at == 2)))
            ),
            self.lemma.feeds.eq(
                ~busy
                | (
                    ((self.run == RUNS) | ((inner["identity"] == board) & (inner["time"] == time)))
                    & (inner["newest"] == (self.index_0 + 1)[:32])
                    & (inner["wanted"] == self.wanted)
                    & (inner["fields"] == self._rotated())
                    & (
                        Cat(inner["malformed"], inner["trusted$2"], inner["early"], inner["late"])
                        == Cat(self.malformed_0, self.trusted_0, self.early, self.late)
                    )
                )
            ),
            self.lemma.compares.eq(
                ~busy
                | (
                    (inner["matches"] == (self.equal & ~newest))
                    & ((newest == 0) | (inner["match"] == (self.equal & newest).any()))
                    & (
                        self.equal >> Mux(self.run == 0, 0, self.run - (self.at <= COMPARED))[:4]
                        == 0
                    )
                    & (inner["judged"] == Mux(self.run == 0, 0, self.run - (self.at < KEPT)))
                )
            ),
            self.holds.eq(
                (inner["valid"] == feeds)
                & (~feeds | ((inner["data"] == byte) & (inner["start$2"] == first)))
                & (dut.done == good)
                & (dut.due == (self.left == 2))
                & (
                    ~dut.done
                    | (
                        (dut.cause == cause)
                        & (dut.good == (cause == Cause.NONE))
                        & (~acceptable | (dut.good_index == index))
                    )
                )
            ),
            self.reached.eq(dut.done & dut.good),
        ]
        return m

    def _times(self, m: Module) -> None:
        """The check's runs, byte by byte, and what it has begun with."""
        with m.If(self.start):
            m.d.sync += [
                self.left.eq(CONFIG.check_ticks),
                self.run.eq(0),
                self.at.eq(0),
                self.index_0.eq(self.index),
                self.fields.eq(Cat(self.acknowledge, self.image, self.sequence)),
                self.wanted.eq(self.crc),
                self.early.eq(self.phase >= CONFIG.cycle_ticks - CONFIG.margin_ticks),
                self.late.eq(self.phase < CONFIG.margin_ticks),
                self.trusted_0.eq(self.trusted),
                self.malformed_0.eq(self.malformed),
            ]
        with m.Elif(self.left != 0):
            m.d.sync += self.left.eq(self.left - 1)
            with m.If(self.run == RUNS):
                m.d.sync += self.at.eq(Mux(self.at == SETTLED, SETTLED, self.at + 1))
            with m.Elif(self.at == COVERED - 1):
                m.d.sync += [self.at.eq(0), self.run.eq(self.run + 1)]
            with m.Else():
                m.d.sync += self.at.eq(self.at + 1)

    def _tried(self, index: Value) -> tuple[Value, Value]:
        """Board and time of this run; the last one's are the mask and the index that was right."""
        newest = self.index_0 + 1
        other = self.run >= TRIED
        board = Mux(other, CONFIG.boards[1], CONFIG.boards[0])
        time = newest - self.run + Mux(other, TRIED, 0)
        last = self.run == 2 * TRIED
        masks = _Table(Const(mask, 32) for mask in CONFIG.masks[0])
        return Mux(last, masks[index[:5]], board)[:32], Mux(last, index, time[:32])[:32]

    def _rotated(self) -> Value:
        """The fields, of which the first bytes of this run have gone to the end."""
        gone = Mux(self.at > IMPLICIT, self.at - IMPLICIT, 0)
        turns = Array(self.fields.rotate_left(8 * n) for n in range(COVERED - IMPLICIT))
        return Mux(self.run == RUNS, self.fields, turns[gone[:4]])


def _checks() -> Trace:
    """Frames of the own board and the other one, of several cycles, one that is none, one without
    a time to trust, and one with whose mask the comparator does not differ."""
    layout, steps = CONFIG.layout, list[Step]()
    values = {"sequence": 0x0123_4567, "image": 0x89AB, "acknowledge": 0x4242}
    late, early = {"phase": 5}, {"phase": CONFIG.cycle_ticks - 5}
    for index, board, ago, beside in (
        (992, 0, 0, {}),
        (1020, 0, 1, late),
        (1021, 0, -1, early),
        (1022, 0, -1, late),
        (1023, 0, 2, {}),
        (1024, 1, 0, {}),
        (1025, 0, 9, {}),
        (1026, 0, 0, {"trusted": 0}),
    ):
        crc = layout.crc(CONFIG.boards[board], index - ago, values)
        told = {"start": 1, "trusted": 1, "index": index, "crc": crc, "phase": 500_000}
        steps += [(1, told | values | beside), (CONFIG.check_ticks, {})]
    crc = layout.crc(CONFIG.boards[0], 1027, values)
    told = {"start": 1, "trusted": 1, "index": 1027, "crc": crc, "phase": 500_000}
    masked = COVERED + SETTLED - KEPT
    steps += [(1, told | values), (CONFIG.check_ticks - masked, {})]
    steps += [(masked, {"wrong": 1 << 1027 % 32}), (2, {})]
    return trace(INPUTS, steps)


CHECKS = Run(_checks().end, _checks)


def _mutant(name: str, old: str, new: str) -> Mutant:
    return mutant(name, "check", old, new, CHECKS)


CLAIMS = (
    Claim(
        name="vital_output.check",
        claim=(
            "For ever and for any frame and time, a check feeds its CRC engine with the frame's "
            "bytes behind each ID and cycle of the contract, byte by byte, at last behind the mask "
            "number index mod 32 and the index that was right; and its verdict, check_ticks after "
            "its start, is the contract's, whatever the comparator tells: good only if in this "
            "very check it has told equality for the own board and an acceptable index, and "
            "inequality with the mask (default configuration). The engine itself is "
            "amaranth.lib.crc's; that a mask changes just its bit of the CRC is shown by the "
            "specification's tests, that no frame is one for the other board at a time near by, by "
            "the validation of board IDs, which tries all differences."
        ),
        requirements=("DRV-2", "DRV-3"),
        monitor=_Check,
        method=Induction(),
        cover=CHECKS,
        mutants=(
            _mutant(
                "mask-unseen",
                "with m.Elif(acceptable & matches[2 * tried]):",
                "with m.Elif(acceptable & matches[2 * tried] & ~trusted):",
            ),
            _mutant("16-masks", "masks[self.good_index[:5]]", "masks[self.good_index[:4]]"),
            _mutant("a-bit-not-compared", "(crc.crc == wanted)", "(crc.crc[1:] == wanted[1:])"),
            _mutant("early-at-any-time", "(matches[0] & early)", "matches[0]"),
            _mutant("other-board", "| matches[1] |", "| matches[1] | matches[tried + 1] |"),
            _mutant("untrusted", "with m.Elif(~trusted):", "with m.Elif(trusted & ~trusted):"),
            _mutant("time-stands", "m.d.sync += time.eq(time - 1)", "m.d.sync += time.eq(time)"),
        ),
        fast=False,
    ),
)
