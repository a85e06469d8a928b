"""A bridge from Wishbone. Ref: Wishbone B4, OpenCores 2010, chapters 2, 3.1 and 4."""

from __future__ import annotations

from amaranth.hdl import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.registers.gateware.access import INDEX_FROM
from railgate.registers.gateware.bus import bus_signature
from railgate.registers.register import WORD_BITS, WORD_BYTES

__all__ = ["Wishbone", "wishbone_signature"]


def wishbone_signature(address_bits: int) -> wiring.Signature:
    """Wishbone B4, pipelined, of 32 data bits with bytes as granules, from the master's side.

    Signals are called as there; adr is ADR(address_bits - 1 .. 2), the word's number.
    """
    return wiring.Signature(
        {
            "cyc": Out(1),
            "stb": Out(1),
            "we": Out(1),
            "adr": Out(address_bits - INDEX_FROM),
            "dat_w": Out(WORD_BITS),
            "sel": Out(WORD_BYTES),
            "stall": In(1),
            "ack": In(1),
            "err": In(1),
            "dat_r": In(WORD_BITS),
        }
    )


class Wishbone(wiring.Component):
    """A pipelined Wishbone B4 slave, in domain sync, CLK_I; its reset is RST_I.

    wb: in, see wishbone_signature. bus: out, see bus_signature. An error on the bus is ERR. One
    access at a time: stall is 1 while one is under way. Of a cycle that the master ends before all
    answers have come these answers are dropped.
    """

    def __init__(self, address_bits: int) -> None:
        super().__init__(
            {"wb": In(wishbone_signature(address_bits)), "bus": Out(bus_signature(address_bits))}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        wb, request, response = self.wb, self.bus.request, self.bus.response
        pending, dropped = Signal(), Signal()
        answers = response.valid & wb.cyc & ~dropped
        m.d.comb += [
            request.valid.eq(wb.cyc & wb.stb & ~pending),
            request.p.address.eq(wb.adr << INDEX_FROM),
            request.p.write.eq(wb.we),
            request.p.data.eq(wb.dat_w),
            request.p.strobes.eq(wb.sel),
            wb.stall.eq(pending | ~request.ready),
            wb.ack.eq(answers & ~response.error),
            wb.err.eq(answers & response.error),
            wb.dat_r.eq(response.data),
        ]
        with m.If(request.valid & request.ready):
            m.d.sync += [pending.eq(1), dropped.eq(0)]
        with m.Elif(response.valid):
            m.d.sync += pending.eq(0)
        with m.If(pending & ~wb.cyc):
            m.d.sync += dropped.eq(1)
        return m
