"""Bytes on a serial line: one start bit, 8 bits, the least significant one first, one stop bit."""

from __future__ import annotations

from amaranth.hdl import Cat, Module
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out

from railgate.primitives import FilteredInput, FractionalDivider, SerialReceiver, SerialTransmitter

__all__ = ["ByteReceiver", "ByteTransmitter"]

BYTE = 8
FILTERED_PART = 8
"""Levels for less than so small a part of a bit are noise."""


class ByteReceiver(wiring.Component):
    """Bytes off the line.

    rx: in, 1 bit, pin, asynchronous. byte: out, 8 bits, and valid: out, 1 bit, for one tick, with
    it. What has no stop bit is no byte.
    """

    def __init__(self, bit_ticks: int) -> None:
        self._bit_ticks = bit_ticks
        super().__init__({"rx": In(1), "byte": Out(BYTE), "valid": Out(1)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.submodules.input = line = FilteredInput(self._bit_ticks // FILTERED_PART)
        m.submodules.receiver = receiver = SerialReceiver(self._bit_ticks, BYTE + 2)
        stop, *bits = receiver.word
        m.d.comb += [
            line.pin.eq(self.rx),
            receiver.level.eq(line.level),
            receiver.fall.eq(line.fall),
            self.byte.eq(Cat(reversed(bits))),
            self.valid.eq(receiver.done & stop),
        ]
        return m


class ByteTransmitter(wiring.Component):
    """Bytes onto the line, without a pause if they come without one.

    bytes: in, a stream of 8 bits. tx: out, 1 bit, pin, register.
    """

    def __init__(self, bit_ticks: int) -> None:
        self._bit_ticks = bit_ticks
        super().__init__({"bytes": In(stream.Signature(BYTE)), "tx": Out(1, init=1)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.submodules.clock = clock = FractionalDivider(1, self._bit_ticks)
        m.submodules.transmitter = transmitter = SerialTransmitter(BYTE + 1)
        # Where it sends nothing the line rests: the strobe in which it could start is the stop bit.
        m.d.comb += [
            transmitter.strobe.eq(clock.strobe),
            self.bytes.ready.eq(clock.strobe & ~transmitter.valid),
            transmitter.start.eq(self.bytes.ready & self.bytes.valid),
            transmitter.frame.eq(Cat(reversed(self.bytes.payload), 0)),
        ]
        m.d.sync += self.tx.eq(~transmitter.valid | transmitter.data)
        return m
