"""One bus to the blocks of a map."""

from __future__ import annotations

from functools import reduce
from operator import or_

from amaranth.hdl import Cat, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.registers.gateware.bus import address_bits, bus_signature
from railgate.registers.map import Map

__all__ = ["Decoder"]


class Decoder(wiring.Component):
    """Hands each request to the block that its address is in; one to none is answered with an error
    in the next tick. Adds no tick.

    bus: in, see bus_signature, with the map's addresses. served: an interface of one bus each, out,
    called as the block, with the block's addresses.
    """

    def __init__(self, map_: Map) -> None:
        self._map = map_
        served = {
            block.name: Out(bus_signature(address_bits(block.size)))
            for block in map_.blocks.values()
        }
        bus = bus_signature(address_bits(map_.size))
        super().__init__({"bus": In(bus), "served": Out(wiring.Signature(served))})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        request, response = self.bus.request, self.bus.response
        hole, answers_hole = Signal(init=1), Signal()
        m.d.comb += request.ready.eq(1)
        m.d.sync += answers_hole.eq(request.valid & hole)
        replies = []
        for base, block in self._map.blocks.items():
            served = getattr(self.served, block.name)
            bits = address_bits(block.size)
            inside = request.p.address >> bits == base >> bits
            m.d.comb += [
                *(
                    getattr(served.request.p, name).eq(getattr(request.p, name))
                    for name in ("address", "write", "data", "strobes")
                ),
                served.request.valid.eq(request.valid & inside),
            ]
            with m.If(inside):
                m.d.comb += [hole.eq(0), request.ready.eq(served.request.ready)]
            reply = served.response
            replies.append(Cat(reply.valid, reply.error, reply.data))
        replies.append(Cat(answers_hole, answers_hole))
        m.d.comb += Cat(response.valid, response.error, response.data).eq(reduce(or_, replies))
        return m
