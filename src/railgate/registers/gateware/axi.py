"""A bridge from AXI4-Lite. Ref: Arm IHI 0022, AMBA AXI, chapter "AXI4-Lite"."""

from __future__ import annotations

from amaranth.hdl import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.registers.gateware.bus import bus_signature
from railgate.registers.register import WORD_BITS, WORD_BYTES

__all__ = ["AxiLite", "axi_signature"]

OKAY, SLVERR = 0b00, 0b10


def axi_signature(address_bits: int) -> wiring.Signature:
    """AXI4-Lite of 32 data bits, from the manager's side, the signals called as there."""
    return wiring.Signature(
        {
            "awaddr": Out(address_bits),
            "awprot": Out(3),
            "awvalid": Out(1),
            "awready": In(1),
            "wdata": Out(WORD_BITS),
            "wstrb": Out(WORD_BYTES),
            "wvalid": Out(1),
            "wready": In(1),
            "bresp": In(2),
            "bvalid": In(1),
            "bready": Out(1),
            "araddr": Out(address_bits),
            "arprot": Out(3),
            "arvalid": Out(1),
            "arready": In(1),
            "rdata": In(WORD_BITS),
            "rresp": In(2),
            "rvalid": In(1),
            "rready": Out(1),
        }
    )


class AxiLite(wiring.Component):
    """An AXI4-Lite subordinate, in domain sync, ACLK; its reset is ARESETn's inverse.

    axi: in, see axi_signature. awprot and arprot count for nothing. bus: out, see bus_signature.
    An error on the bus is SLVERR. One access at a time; where a read and a write wait for one
    another, they take turns. No output depends on an input of the same tick.
    """

    def __init__(self, address_bits: int) -> None:
        super().__init__(
            {"axi": In(axi_signature(address_bits)), "bus": Out(bus_signature(address_bits))}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        axi, request, response = self.axi, self.bus.request, self.bus.response

        # What the manager has told of the next write and of the next read.
        address, data, read = Signal(), Signal(), Signal()
        write_address = Signal.like(axi.awaddr)
        read_address = Signal.like(axi.araddr)
        m.d.comb += [axi.awready.eq(~address), axi.wready.eq(~data), axi.arready.eq(~read)]
        with m.If(axi.awvalid & axi.awready):
            m.d.sync += [address.eq(1), write_address.eq(axi.awaddr)]
        with m.If(axi.wvalid & axi.wready):
            m.d.sync += [
                data.eq(1),
                request.p.data.eq(axi.wdata),
                request.p.strobes.eq(axi.wstrb),
            ]
        with m.If(axi.arvalid & axi.arready):
            m.d.sync += [read.eq(1), read_address.eq(axi.araddr)]

        write = address & data
        writes = request.p.write  # in IDLE that of the access before
        with m.FSM():
            with m.State("IDLE"):
                with m.If(write & (~writes | ~read)):
                    m.d.sync += [writes.eq(1), request.p.address.eq(write_address)]
                    m.next = "ASKS"
                with m.Elif(read):
                    m.d.sync += [writes.eq(0), request.p.address.eq(read_address)]
                    m.next = "ASKS"
            with m.State("ASKS"):
                m.d.comb += request.valid.eq(1)
                with m.If(request.ready):
                    m.next = "WAITS"
            with m.State("WAITS"), m.If(response.valid):
                resp = response.error << 1
                with m.If(writes):
                    m.d.sync += [axi.bvalid.eq(1), axi.bresp.eq(resp), address.eq(0), data.eq(0)]
                with m.Else():
                    m.d.sync += [axi.rvalid.eq(1), axi.rresp.eq(resp), read.eq(0)]
                    m.d.sync += axi.rdata.eq(response.data)
                m.next = "ANSWERS"
            with m.State("ANSWERS"):
                with m.If(axi.bvalid & axi.bready):
                    m.d.sync += axi.bvalid.eq(0)
                    m.next = "IDLE"
                with m.If(axi.rvalid & axi.rready):
                    m.d.sync += axi.rvalid.eq(0)
                    m.next = "IDLE"
        return m
