"""The requests of a serial line, made on the bus, once each."""

from __future__ import annotations

from amaranth.hdl import Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out

from railgate.registers.gateware.access import INDEX_FROM
from railgate.registers.gateware.bus import bus_signature
from railgate.registers.gateware.uart.frames import FrameReceiver, FrameTransmitter
from railgate.registers.gateware.uart.line import ByteReceiver, ByteTransmitter
from railgate.registers.gateware.uart.protocol import ANSWER, REQUEST, Operation, Status
from railgate.registers.register import WORD_BITS, WORD_BYTES

__all__ = ["Uart"]

AROUND = 3
"""Words of a request beside what it writes: the first one, its address, its CRC."""


class Uart(wiring.Component):
    """Serves one host on a serial line by the protocol of this package, in domain sync.

    bit_ticks: of the line, at least 8; the host's may differ by 2 %. words: the most of a request,
    1 … 255. rx: in, 1 bit, pin, asynchronous. tx: out, 1 bit, pin, register. bus: out, see
    bus_signature. Raises ValueError.
    """

    def __init__(self, address_bits: int, bit_ticks: int, words: int = 64) -> None:
        if bit_ticks < 8:
            raise ValueError(f"bit_ticks must be at least 8, not {bit_ticks}")
        if not 1 <= words <= 255:
            raise ValueError(f"words must be between 1 and 255, not {words}")
        self._bit_ticks = bit_ticks
        self._words = words
        super().__init__(
            {"rx": In(1), "tx": Out(1, init=1), "bus": Out(bus_signature(address_bits))}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.submodules.receiver = receiver = ByteReceiver(self._bit_ticks)
        m.submodules.transmitter = transmitter = ByteTransmitter(self._bit_ticks)
        m.submodules.frames = frames = FrameReceiver(self._words + AROUND)
        m.submodules.answers = answers = FrameTransmitter()
        m.d.comb += [
            receiver.rx.eq(self.rx),
            frames.byte.eq(receiver.byte),
            frames.valid.eq(receiver.valid),
            self.tx.eq(transmitter.tx),
        ]
        wiring.connect(m, answers.bytes, transmitter.bytes)
        m.submodules.wanted = wanted = Memory(shape=WORD_BITS, depth=self._words, init=[])
        m.submodules.got = got = Memory(shape=WORD_BITS, depth=self._words, init=[])
        put, written = wanted.write_port(), wanted.read_port()
        keep, kept = got.write_port(), got.read_port()

        asked, address = Signal(REQUEST), Signal(WORD_BITS)
        m.d.comb += [put.addr.eq(frames.index - (AROUND - 1)), put.data.eq(frames.word)]
        with m.If(frames.there), m.Switch(frames.index):
            with m.Case(0):
                m.d.sync += asked.eq(frames.word)
            with m.Case(1):
                m.d.sync += address.eq(frames.word)
            with m.Default():
                m.d.comb += put.en.eq(frames.index < self._words + AROUND - 1)

        # `check` is the CRC of the request that `answer` and `got` belong to.
        answer, check, any_yet = Signal(ANSWER), Signal(WORD_BITS), Signal()
        request, response = self.bus.request, self.bus.response
        hello = asked.operation == Operation.HELLO
        reads = asked.operation == Operation.READ
        writes = asked.operation == Operation.WRITE
        fits = (asked.count != 0) & (asked.count <= self._words)
        end, length = Signal(WORD_BITS), Signal(range(256 + AROUND))
        inside = (address[:INDEX_FROM] == 0) & (end <= 1 << len(request.p.address) - INDEX_FROM)
        # In registers, since long: a request's words stand still while its frame's END is received.
        whole, accesses, again = Signal(), Signal(), Signal()
        m.d.sync += [
            end.eq((address >> INDEX_FROM) + asked.count),
            length.eq(Mux(writes, asked.count, 0) + AROUND),
            whole.eq(frames.index == length),
            accesses.eq(fits & inside & (reads | writes)),
            again.eq(any_yet & (frames.word == check)),
        ]
        at = Signal(range(self._words + 1))  # which of the request's or the answer's words
        last_asked, last_told = Signal(), Signal()  # it is the last one; it stands for two ticks
        m.d.sync += [
            last_asked.eq(at + 1 == asked.count),
            last_told.eq(at + 1 == answer.count),
        ]
        m.d.comb += [
            written.addr.eq(at),
            kept.addr.eq(at),
            keep.addr.eq(at),
            keep.data.eq(response.data),
            request.p.address.eq(address + at * WORD_BYTES),
            request.p.write.eq(writes),
            request.p.data.eq(written.data),
            request.p.strobes.eq(~0),
            frames.hold.eq(1),
        ]
        with m.FSM():
            with m.State("LISTENS"):
                m.d.comb += frames.hold.eq(0)
                m.d.sync += at.eq(0)
                with m.If(frames.done):
                    m.next = "ANSWERS"
                with m.If(frames.done & ~again):
                    m.d.sync += [
                        any_yet.eq(1),
                        check.eq(frames.word),
                        answer.number.eq(asked.number),
                        answer.status.eq(Status.REFUSED),
                        answer.count.eq(0),
                    ]
                    with m.If(whole & hello):
                        m.d.sync += [answer.status.eq(Status.DONE), answer.count.eq(self._words)]
                    with m.If(whole & accesses):
                        m.d.sync += answer.status.eq(Status.DONE)
                        m.next = "FETCHES"
            with m.State("FETCHES"):
                m.next = "ASKS"
            with m.State("ASKS"):
                m.d.comb += request.valid.eq(1)
                with m.If(request.ready):
                    m.next = "WAITS"
            with m.State("WAITS"):
                m.d.comb += keep.en.eq(response.valid)
                with m.If(response.valid & response.error):
                    m.d.sync += answer.status.eq(Status.BUS_ERROR)
                    m.next = "ANSWERS"
                with m.Elif(response.valid):
                    m.d.sync += [at.eq(at + 1), answer.count.eq(answer.count + 1)]
                    m.next = "FETCHES"
                    with m.If(last_asked):
                        m.next = "ANSWERS"
            with m.State("ANSWERS"):
                last = ~reads | (answer.count == 0)
                m.d.comb += [
                    answers.words.valid.eq(1),
                    answers.words.p.word.eq(answer),
                    answers.words.p.last.eq(last),
                ]
                m.d.sync += at.eq(0)
                with m.If(answers.words.ready):
                    m.next = "FINDS"
                    with m.If(last):
                        m.next = "LISTENS"
            with m.State("FINDS"):
                m.next = "TELLS"
            with m.State("TELLS"):
                m.d.comb += [
                    answers.words.valid.eq(1),
                    answers.words.p.word.eq(kept.data),
                    answers.words.p.last.eq(last_told),
                ]
                with m.If(answers.words.ready):
                    m.d.sync += at.eq(at + 1)
                    m.next = "FINDS"
                    with m.If(last_told):
                        m.next = "LISTENS"
        return m
