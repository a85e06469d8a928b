"""Frames of words: off a line's bytes, and onto them."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal, Value
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

from railgate.registers.gateware.uart.protocol import BYTE, CRC, END, ESCAPE, ESCAPED
from railgate.registers.register import WORD_BITS, WORD_BYTES

__all__ = ["FrameReceiver", "FrameTransmitter"]


class FrameReceiver(wiring.Component):
    """Takes frames of up to `most` words apart.

    byte, valid: in, see ByteReceiver. hold: in, 1 bit: what comes is dropped, and all that
    comes after it up to the next END. word: out, 32 bits, register; there: out, 1 bit, for one
    tick: a word is complete. index: out, how many words of this frame have been before, `most` + 1
    at most. done: out, 1 bit, for one tick: a frame with the right CRC has ended, of `index` words,
    the last of which, the CRC, `word` is.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        super().__init__(
            {
                "byte": In(BYTE),
                "valid": In(1),
                "hold": In(1),
                "word": Out(WORD_BITS),
                "there": Out(1),
                "index": Out(range(most + 2)),
                "done": Out(1),
            }
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.submodules.check = check = CRC.create()
        escaped, spoilt = Signal(), Signal(init=1)
        place = Signal(range(WORD_BYTES))
        end = self.valid & (self.byte == END)
        escape = self.valid & (self.byte == ESCAPE) & ~escaped
        takes = self.valid & ~end & ~escape
        byte = Signal(BYTE)
        m.d.comb += byte.eq(self.byte)
        # Ready long before a byte comes: the check stands still from byte to byte.
        matches = Signal()
        m.d.sync += matches.eq(check.match_detected)
        for plain, code in ESCAPED.items():
            with m.If(escaped & (self.byte == code)):
                m.d.comb += byte.eq(plain)

        m.d.comb += [
            check.start.eq(end),
            check.valid.eq(takes),
            check.data.eq(byte),
            self.done.eq(end & ~spoilt & (place == 0) & matches),
        ]
        m.d.sync += self.there.eq(takes & (place == WORD_BYTES - 1))
        with m.If(self.there & (self.index <= self._most)):
            m.d.sync += self.index.eq(self.index + 1)
        with m.If(takes):
            m.d.sync += [
                self.word.eq(Cat(self.word[BYTE:], byte)),
                place.eq(place + 1),
                escaped.eq(0),
            ]
        with m.If(escape):
            m.d.sync += escaped.eq(1)
        with m.If(end):
            m.d.sync += [place.eq(0), self.index.eq(0), escaped.eq(0), spoilt.eq(0)]
        with m.If(self.hold):
            m.d.sync += spoilt.eq(1)
        return m


class FrameTransmitter(wiring.Component):
    """Makes frames of words, with their CRC.

    words: in, a stream of word, 32 bits, and last, 1 bit: it is the frame's last but the CRC.
    bytes: out, a stream of 8 bits.
    """

    def __init__(self) -> None:
        words = data.StructLayout({"word": WORD_BITS, "last": 1})
        super().__init__(
            {"words": In(stream.Signature(words)), "bytes": Out(stream.Signature(BYTE))}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.submodules.check = check = CRC.create()
        rest, place = Signal(WORD_BITS), Signal(range(WORD_BYTES))
        last, checks, escaped = Signal(), Signal(), Signal()
        byte = rest[:BYTE]
        m.d.comb += check.data.eq(byte)
        with m.FSM():
            with m.State("IDLE"), m.If(self.words.valid):
                self._end(m, "TAKES")
                m.d.comb += check.start.eq(1)
            with m.State("TAKES"):
                m.d.comb += self.words.ready.eq(1)
                m.d.sync += [
                    rest.eq(self.words.p.word),
                    last.eq(self.words.p.last),
                    checks.eq(0),
                ]
                with m.If(self.words.valid):
                    m.next = "SENDS"
            with m.State("SENDS"):
                escapes = Cat(byte == plain for plain in ESCAPED).any() & ~escaped
                m.d.comb += [
                    self.bytes.valid.eq(1),
                    self.bytes.payload.eq(Mux(escapes, ESCAPE, _coded(m, byte, escaped))),
                ]
                with m.If(self.bytes.ready):
                    m.d.sync += escaped.eq(escapes)
                    with m.If(~escapes):
                        m.d.comb += check.valid.eq(~checks)
                        m.d.sync += [rest.eq(rest >> BYTE), place.eq(place + 1)]
                    with m.If(~escapes & (place == WORD_BYTES - 1)):
                        m.next = "TAKES"
                        with m.If(last):
                            m.next = "CHECKS"
                        with m.If(checks):
                            m.next = "ENDS"
            with m.State("CHECKS"):
                m.d.sync += [rest.eq(check.crc), checks.eq(1)]
                m.next = "SENDS"
            with m.State("ENDS"):
                self._end(m, "IDLE")
        return m

    def _end(self, m: Module, following: str) -> None:
        m.d.comb += [self.bytes.valid.eq(1), self.bytes.payload.eq(END)]
        with m.If(self.bytes.ready):
            m.next = following


def _coded(m: Module, byte: Value, escaped: Value) -> Value:
    """The byte, after ESCAPE what stands for it."""
    coded = Signal(BYTE)
    m.d.comb += coded.eq(byte)
    for plain, code in ESCAPED.items():
        with m.If(escaped & (byte == plain)):
            m.d.comb += coded.eq(code)
    return coded
