"""The own CPU's command frames: read, checked, and held to their sequence."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal, Value, signed
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

from railgate.vital_output.gateware.check import FrameCheck
from railgate.vital_output.spec import Cause, Config

__all__ = ["BYTE", "Command"]

BYTE = data.StructLayout({"data": 8, "first": 1, "last": 1})
"""What the command stream carries: a byte, and whether it begins or ends a frame."""


class Command(wiring.Component):
    """Tells of each command frame, check_ticks after its last byte, what becomes of it.

    board: which of config.boards is the own one.
    command: in, a stream of BYTE. index: in, 32 bits, phase: in, ticks, trusted: in, 1 bit, see
    Timekeeper. lifeless: in, 1 bit, the image has no life. life_ends: in, 1 bit, event, from the
    next tick on it has none.
    Events, 1 bit each: accepted, started: out, the frame is accepted, begins a sequence (START).
    rejected: out, what is told by `cause` is a rejection. cause: out, see Cause, of the verdict's
    tick, else NONE. With `accepted` are valid: lost: out, so many frames are missing before this
    one; sequence, image, acknowledge, crc: out, its fields, 32 bits, one an output twice, 32 bits;
    frame_index: out, 32 bits, the cycle in which it was sent. Requirements DRV-1, DRV-2, DRV-5.
    """

    def __init__(self, config: Config, board: int) -> None:
        self._config = config
        self._board = board
        super().__init__(
            {
                "command": In(stream.Signature(BYTE)),
                "index": In(32),
                "phase": In(range(config.cycle_ticks + config.slew_ticks)),
                "trusted": In(1),
                "lifeless": In(1),
                "life_ends": In(1),
                "accepted": Out(1),
                "started": Out(1),
                "rejected": Out(1),
                "cause": Out(range(max(Cause) + 1)),
                "lost": Out(range(config.life_cycles)),
                "sequence": Out(32),
                "image": Out(config.outputs),
                "acknowledge": Out(config.outputs),
                "crc": Out(32),
                "frame_index": Out(32),
            }
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config = self._config
        m.submodules.check = check = FrameCheck(config, self._board, config.margin_ticks)
        received, frame = self._receive(m, check)
        m.d.comb += [
            check.index.eq(self.index),
            check.phase.eq(self.phase),
            check.trusted.eq(self.trusted),
            check.frame.sequence.eq(received.sequence),
            check.frame.image.eq(received.image),
            check.frame.acknowledge.eq(received.acknowledge),
            check.frame.crc.eq(received.crc),
            self.sequence.eq(frame.sequence),
            self.image.eq(frame.image),
            self.acknowledge.eq(frame.acknowledge),
            self.crc.eq(frame.crc),
            self.frame_index.eq(check.good_index),
        ]
        self._judge(m, check)
        return m

    def _receive(self, m: Module, check: FrameCheck) -> tuple[data.View, data.View]:
        """Starts a check with the last byte. The frame as it is in that tick, and afterwards."""
        layout = self._config.layout
        fields = data.StructLayout({field.name: field.width for field in reversed(layout.frame)})
        begun = Signal()
        repeated = Signal()
        count = Signal(range(layout.frame_bytes + 1))  # bytes before this one, frame_bytes if more
        frame = Signal(fields)
        received = Signal(fields)

        byte = self.command.payload
        transfer = self.command.valid & self.command.ready
        once = (begun ^ byte.first) & ~repeated
        complete = ~byte.first & (count == layout.frame_bytes - 1)
        beyond = Cat(self._beyond(received.image), self._beyond(received.acknowledge))
        m.d.comb += [
            received.as_value().eq(Cat(byte.data, frame.as_value())),
            check.start.eq(transfer & byte.last),
            check.frame.malformed.eq(~(once & complete) | beyond.any()),
        ]
        with m.If(transfer):
            m.d.sync += frame.eq(received)
            m.d.sync += begun.eq((begun | byte.first) & ~byte.last)
            m.d.sync += repeated.eq((repeated | (begun & byte.first)) & ~byte.last)
            with m.If(byte.first):
                m.d.sync += count.eq(1)
            with m.Elif(count != layout.frame_bytes):
                m.d.sync += count.eq(count + 1)

        ready = Signal(init=1)
        m.d.comb += self.command.ready.eq(ready)
        with m.If(check.start):
            m.d.sync += ready.eq(0)
        with m.Elif(check.due):
            m.d.sync += ready.eq(1)
        return received, frame

    def _beyond(self, bits: Value) -> Value:
        """Those that belong to no output."""
        return bits[self._config.outputs :]

    def _judge(self, m: Module, check: FrameCheck) -> None:
        """The verdict's tick: what a good frame's sequence number makes of it."""
        reference = Signal(32)
        referenced = Signal()
        # Neither of the two has changed in the tick before a verdict.
        step = Signal(signed(32))
        m.d.sync += step.eq(self.sequence - reference)

        good = check.done & check.good
        within = ~self.lifeless & (step >= 1) & (step <= self._config.life_cycles)
        m.d.comb += [
            self.accepted.eq(good & referenced & ((step == 1) | within)),
            self.started.eq(good & ~referenced),
            self.lost.eq(step - 1),
            self.rejected.eq((self.cause != Cause.NONE) & (self.cause != Cause.TIME)),
        ]
        with m.If(check.done & ~check.good):
            m.d.comb += self.cause.eq(check.cause)
        with m.Elif(good & referenced & ~self.accepted):
            out_of_order = Mux(step < 0, Cause.RESEQUENCE, Cause.INSERTION)
            m.d.comb += self.cause.eq(Mux(step == 0, Cause.REPETITION, out_of_order))

        with m.If(self.life_ends):
            m.d.sync += referenced.eq(0)
        with m.If(self.accepted | (good & self.lifeless)):
            m.d.sync += [reference.eq(self.sequence), referenced.eq(1)]
