"""The bus from one clock to another."""

from __future__ import annotations

from amaranth.hdl import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.wiring import In, Out

from railgate.registers.gateware.bus import bus_signature

__all__ = ["BusCrossing"]


class BusCrossing(wiring.Component):
    """Takes requests in one domain and makes them in another one; their clocks may be any.

    bus: in, see bus_signature, of domain `requester`. served: out, see bus_signature, of domain
    `server`.

    A request is a level that stays, with what it asks, until its answer has been seen; the answer
    stays until the request has gone: whatever crosses stands still while it is read, if its lines
    are no slower than two ticks of the domain that reads. Either side can be reset by itself: a
    request that was under way may then be made twice, or be lost.
    """

    def __init__(self, address_bits: int, requester: str, server: str) -> None:
        self._requester = requester
        self._server = server
        signature = bus_signature(address_bits)
        super().__init__({"bus": In(signature), "served": Out(signature)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        asks, answers = Signal(), Signal()  # levels, registers of requester and server
        asks_there, answers_here = Signal(), Signal()
        m.submodules.asks = FFSynchronizer(asks, asks_there, o_domain=self._server)
        m.submodules.answers = FFSynchronizer(answers, answers_here, o_domain=self._requester)

        taken = Signal.like(self.bus.request.p)
        answer = Signal.like(self.served.response.data)
        error = Signal()
        m.d.comb += self.served.request.p.eq(taken)
        with m.If(~asks & ~answers_here):
            m.d.comb += self.bus.request.ready.eq(1)
            with m.If(self.bus.request.valid):
                m.d[self._requester] += [taken.eq(self.bus.request.p), asks.eq(1)]
        with m.If(asks & answers_here):
            m.d[self._requester] += asks.eq(0)
            m.d.comb += [
                self.bus.response.valid.eq(1),
                self.bus.response.data.eq(answer),
                self.bus.response.error.eq(error),
            ]

        with m.FSM(domain=self._server):
            with m.State("IDLE"), m.If(asks_there):
                m.next = "ASKS"
            with m.State("ASKS"):
                m.d.comb += self.served.request.valid.eq(1)
                with m.If(self.served.request.ready):
                    m.next = "WAITS"
            with m.State("WAITS"), m.If(self.served.response.valid):
                m.d[self._server] += [
                    answers.eq(1),
                    answer.eq(self.served.response.data),
                    error.eq(self.served.response.error),
                ]
                m.next = "ANSWERS"
            with m.State("ANSWERS"), m.If(~asks_there):
                m.d[self._server] += answers.eq(0)
                m.next = "IDLE"
        return m
