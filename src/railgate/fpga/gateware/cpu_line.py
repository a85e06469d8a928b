"""A serial line on which a CPU sends a channel its commands and the time, for boards on a desk.

It stands in for the network, and adds nothing to a command's safety: that is in the command's own
CRC. Frames are those of the UART bridge, see registers.gateware.uart: of words, with a CRC. The
first word has what it is in its lowest byte.

    time      0 | boot << 16, index, phase       the time as of the frame's end; boot: see Channel
    command   1, the command frame's bytes, filled up to whole words

A frame of another length, or of another kind, is dropped.
"""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Signal
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In

from railgate.registers import WORD_BITS, WORD_BYTES
from railgate.registers.gateware.uart.frames import FrameReceiver
from railgate.registers.gateware.uart.line import ByteReceiver
from railgate.vital_output.spec import Config

__all__ = ["FED", "CpuLine"]

FED = ("command", "time", "boot")
"""Members of a channel that come over the line."""

TIME, COMMAND = 0, 1
TIME_WORDS = 4
"""Of a frame: what it is, index, phase, CRC."""
HEADER = data.StructLayout({"kind": 16, "boot": 16})


class CpuLine(wiring.Component):
    """Takes commands and the time off a line, in domain sync.

    channel: the signature of the Channel, which the line serves. bit_ticks: of the line. rx: in,
    1 bit, pin, asynchronous. command, time, boot: out, see Channel; boot is the last time's, 0
    before the first.
    """

    def __init__(self, config: Config, channel: wiring.Signature, bit_ticks: int) -> None:
        self._config = config
        self._bit_ticks = bit_ticks
        fed = {name: channel.members[name].flip() for name in FED}
        super().__init__({"rx": In(1)} | fed)

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        count = self._config.layout.frame_bytes
        words = -(-count // WORD_BYTES)
        m.submodules.receiver = receiver = ByteReceiver(self._bit_ticks)
        m.submodules.frames = frames = FrameReceiver(words + 2)
        m.d.comb += [
            receiver.rx.eq(self.rx),
            frames.byte.eq(receiver.byte),
            frames.valid.eq(receiver.valid),
        ]
        # The last words of a frame: those of a command, or the index and the phase; then the CRC.
        header, held = Signal(HEADER), Signal((words + 1) * WORD_BITS)
        with m.If(frames.there):
            m.d.sync += held.eq(Cat(held[WORD_BITS:], frames.word))
        with m.If(frames.there & (frames.index == 0)):
            m.d.sync += header.eq(frames.word)
        index, phase, _ = (held.word_select(words + 1 - place, WORD_BITS) for place in (3, 2, 1))
        m.d.comb += [self.time.index.eq(index), self.time.phase.eq(phase)]

        at, sends = Signal(range(count)), Signal()
        fits = phase >> len(self.time.phase) == 0
        with m.If(frames.done & (header.kind == TIME) & (frames.index == TIME_WORDS) & fits):
            m.d.comb += self.time.valid.eq(1)
            m.d.sync += self.boot.eq(header.boot)
        with m.If(frames.done & (header.kind == COMMAND) & (frames.index == words + 2)):
            m.d.sync += sends.eq(1)
        m.d.comb += [
            frames.hold.eq(sends),
            self.command.valid.eq(sends),
            self.command.p.data.eq(held.word_select(at, len(self.command.p.data))),
            self.command.p.first.eq(at == 0),
            self.command.p.last.eq(at == count - 1),
        ]
        with m.If(sends & self.command.ready):
            m.d.sync += at.eq(at + 1)
            with m.If(self.command.p.last):
                m.d.sync += [at.eq(0), sends.eq(0)]
        return m
