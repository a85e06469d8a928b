"""What an access to a bank does in which tick."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.registers.gateware.bus import bus_signature
from railgate.registers.register import WORD_BITS, WORD_BYTES

__all__ = ["INDEX_FROM", "BusAccess"]

INDEX_FROM = WORD_BYTES.bit_length() - 1
"""The lowest bit of an address that counts."""


class BusAccess(wiring.Component):
    """Takes each request apart: gate in the tick after it, done in the one after that, or when it
    waits no more, answered in the next.

    bus: in, see bus_signature. index: out, the word of the access, from the tick after the request
    on. gate: out, 1 bit, of a read. read, write: out, 1 bit, the access is done in this tick.
    data: out, what is written; mask: out, 1 in each of its bits whose strobe is. told: in, what a
    read tells, and readable, writable: in, 1 bit, whether there is anything to read, to write: all
    three of this index, in the tick in which the access is done. waits: in, 1 bit, a read cannot be
    done in this tick.
    """

    def __init__(self, address_bits: int) -> None:
        super().__init__(
            {
                "bus": In(bus_signature(address_bits)),
                "index": Out(address_bits - INDEX_FROM),
                "gate": Out(1),
                "read": Out(1),
                "write": Out(1),
                "data": Out(WORD_BITS),
                "mask": Out(WORD_BITS),
                "waits": In(1),
                "told": In(WORD_BITS),
                "readable": In(1),
                "writable": In(1),
            }
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        request, response = self.bus.request, self.bus.response
        taken = Signal.like(request.payload)
        allowed = (self.read & self.readable) | (self.write & self.writable)
        m.d.comb += [
            self.index.eq(taken.address[INDEX_FROM:]),
            self.data.eq(taken.data),
            self.mask.eq(Cat(strobe.replicate(8) for strobe in taken.strobes)),
        ]
        m.d.sync += [
            response.valid.eq(self.read | self.write),
            response.error.eq((self.read | self.write) & ~allowed),
            response.data.eq(0),
        ]
        with m.If(self.read & self.readable):
            m.d.sync += response.data.eq(self.told)
        with m.FSM():
            with m.State("IDLE"):
                m.d.comb += request.ready.eq(1)
                with m.If(request.valid):
                    m.d.sync += taken.eq(request.payload)
                    m.next = "GATE"
            with m.State("GATE"):
                m.d.comb += self.gate.eq(~taken.write)
                m.next = "DONE"
            with m.State("DONE"), m.If(~self.waits | taken.write):
                m.d.comb += [self.read.eq(~taken.write), self.write.eq(taken.write)]
                m.next = "IDLE"
        return m
