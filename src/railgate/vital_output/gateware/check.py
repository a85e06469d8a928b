"""A frame's check: whose it is and of which cycle, told by its CRC alone."""

from __future__ import annotations

from amaranth.hdl import Array, Cat, Const, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.crc import Algorithm, Processor
from amaranth.lib.wiring import In, Out

from railgate.primitives import OneShot
from railgate.vital_output.spec import Cause, Config
from railgate.vital_output.spec.frame import CRC_BITS

__all__ = ["FrameCheck", "frame_signature"]


def frame_signature(config: Config) -> wiring.Signature:
    """A frame to be checked: its fields without their padding, and whether its form is wrong."""
    return wiring.Signature(
        {
            "sequence": Out(32),
            "image": Out(config.outputs),
            "acknowledge": Out(config.outputs),
            "crc": Out(CRC_BITS),
            "malformed": Out(1),
        }
    )


class FrameCheck(wiring.Component):
    """Computes a frame's CRC for each board and cycle that is tried, then with the mask.

    board: which of config.boards the frame must be for. late_ticks: so far from the start of a
    cycle a frame of the one before is acceptable.
    start: in, 1 bit, a check begins, at least check_ticks after the last one; with it are read:
    frame: in, see frame_signature; index: in, 32 bits, phase: in, ticks, trusted: in, 1 bit, see
    Timekeeper.
    due: out, 1 bit, in the tick before `done`. done: out, 1 bit, check_ticks after the start; with
    it are valid: good: out, 1 bit. cause: out, see Cause, NONE if good. good_index: out, 32 bits,
    the cycle in which a good frame was sent. Requirements DRV-2, DRV-3, DRV-6.

    Runs 0, 1, … are for the own board and the cycles from index + 1 downwards, as many more for the
    other board, the last one is with the mask. A byte goes from its register `byte` into the CRC
    and this, when it is whole, into `match`; config.check_overhead_ticks has room for that.
    """

    def __init__(self, config: Config, board: int, late_ticks: int) -> None:
        self._config = config
        self._board = board
        self._late_ticks = late_ticks
        super().__init__(
            {
                "start": In(1),
                "frame": In(frame_signature(config)),
                "index": In(32),
                "phase": In(range(config.cycle_ticks + config.slew_ticks)),
                "trusted": In(1),
                "due": Out(1),
                "done": Out(1),
                "good": Out(1),
                "cause": Out(range(max(Cause) + 1)),
                "good_index": Out(32),
            }
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config = self._config
        implicit = config.layout.implicit_bytes
        covered = implicit + config.layout.frame_bytes - CRC_BITS // 8
        tried = config.delay_cycles + 2
        runs = 2 * tried + 1
        own, other = config.boards[self._board], config.boards[1 - self._board]

        m.submodules.until_done = until_done = OneShot(config.check_ticks)
        m.d.comb += [
            until_done.trigger.eq(self.start),
            self.due.eq(until_done.remaining == 2),
            self.done.eq(until_done.remaining == 1),
        ]

        run = Signal(range(runs + 1), init=runs)
        at = Signal(range(covered))
        last = at == covered - 1
        with m.If(self.start):
            m.d.sync += [run.eq(0), at.eq(0)]
        with m.Elif(run != runs):
            m.d.sync += at.eq(Mux(last, 0, at + 1))
            m.d.sync += run.eq(run + last)

        identity = Signal(32)
        time = Signal(32)
        newest = Signal(32)
        masks = Array(Const(mask, 32) for mask in config.masks[self._board])
        with m.If(self.start):
            m.d.sync += [identity.eq(own), time.eq(self.index + 1), newest.eq(self.index + 1)]
        with m.Elif(last):
            m.d.sync += time.eq(time - 1)
            with m.If(run == tried - 1):
                m.d.sync += [identity.eq(other), time.eq(newest)]
            with m.If(run == 2 * tried - 1):
                m.d.sync += [identity.eq(masks[self.good_index[:5]]), time.eq(self.good_index)]

        fields = Signal(8 * (covered - implicit))
        with m.If(self.start):
            m.d.sync += fields.eq(self._fields())
        with m.Elif(at >= implicit):
            m.d.sync += fields.eq(fields.rotate_left(8))
        byte = Signal(8)
        first = Signal()
        valid = Signal()
        whole = Signal(2)  # a run's last byte is in `byte`, is in the CRC
        m.d.sync += [
            byte.eq(Mux(at < implicit, _byte(Cat(time, identity), at[:3]), fields[-8:])),
            first.eq(at == 0),
            valid.eq(run != runs),
            whole.eq(Cat((run != runs) & last, whole)),
        ]

        m.submodules.crc = crc = self._processor()
        m.d.comb += [crc.data.eq(byte), crc.start.eq(first), crc.valid.eq(valid)]
        wanted = Signal(CRC_BITS)
        match = Signal()
        m.d.sync += match.eq(crc.crc == wanted)
        judged = Signal(range(runs + 1))
        judges = Signal()
        matches = Signal(runs)
        m.d.sync += judges.eq(whole[1])
        with m.If(judges):
            m.d.sync += [matches.bit_select(judged, 1).eq(match), judged.eq(judged + 1)]
        with m.If(self.start):
            # No match of the frame before outlives its check, even if an upset ends this one early.
            m.d.sync += [wanted.eq(self.frame.crc), matches.eq(0), judged.eq(0)]

        self._verdict(m, matches, newest, tried)
        return m

    def _fields(self) -> Value:
        """The frame's fields that its CRC covers, as they are laid out."""
        covered = self._config.layout.frame[:-1]
        padded = ((getattr(self.frame, field.name), field.width) for field in covered)
        return Cat(*reversed([Cat(value, Const(0, w - len(value))) for value, w in padded]))

    def _processor(self) -> Processor:
        check = self._config.layout.check
        return Algorithm(
            crc_width=check.width,
            polynomial=check.polynomial,
            initial_crc=check.initial,
            reflect_input=False,
            reflect_output=False,
            xor_output=check.final,
        )(data_width=8).create()

    def _verdict(self, m: Module, matches: Signal, newest: Signal, tried: int) -> None:
        """Cause and index, from what was told at the start and the runs that matched."""
        config = self._config
        malformed = Signal()
        trusted = Signal()
        early = Signal()
        late = Signal()
        with m.If(self.start):
            m.d.sync += [
                malformed.eq(self.frame.malformed),
                trusted.eq(self.trusted),
                early.eq(self.phase >= config.cycle_ticks - config.margin_ticks),
                late.eq(self.phase < self._late_ticks),
            ]
        acceptable = (matches[0] & early) | matches[1] | (matches[2] & late)
        m.d.comb += self.good_index.eq(newest - Cat(matches[1], matches[2]))
        with m.If(malformed):
            m.d.comb += self.cause.eq(Cause.FORMAT)
        with m.Elif(~trusted):
            m.d.comb += self.cause.eq(Cause.TIME)
        with m.Elif(acceptable & matches[2 * tried]):
            m.d.comb += self.cause.eq(Cause.COMPARATOR)
        with m.Elif(acceptable):
            m.d.comb += self.cause.eq(Cause.NONE)
        with m.Elif(matches[:tried].any()):
            m.d.comb += self.cause.eq(Cause.DELAY)
        with m.Elif(matches[tried : 2 * tried].any()):
            m.d.comb += self.cause.eq(Cause.MASQUERADE)
        with m.Else():
            m.d.comb += self.cause.eq(Cause.CORRUPTION)
        m.d.comb += self.good.eq(self.cause == Cause.NONE)


def _byte(bits: Value, number: Value) -> Value:
    """Byte `number` of the bits, counted from the most significant."""
    return bits.word_select(~number, 8)
