"""The stamps of every edge, for estimators that need each one."""

from __future__ import annotations

from amaranth.hdl import Module, Mux, Signal
from amaranth.lib import data, stream, wiring
from amaranth.lib.fifo import SyncFIFOBuffered
from amaranth.lib.wiring import In, Out

from railgate.odometer.spec import STAMP, Config

__all__ = ["STAMP_LAYOUT", "Stamps"]

STAMP_LAYOUT = data.StructLayout({field.name: field.width for field in STAMP})
"""One entry, least significant field first."""

FIFO_TICKS = 2
"""From writing into the empty FIFO to its offering the entry."""


class Stamps(wiring.Component):
    """A FIFO of `stamp_depth` entries, each offered `stamp_latency_ticks` after its edge.

    edge: in, 1 bit, there was an edge of either channel in the tick before. ticks: in, that tick,
    modulo 2³². a, b: in, 1 bit, the levels after it. overflow: out, 1 bit, its entry is dropped.
    stamps: out, stream of STAMP_LAYOUT; its payload is 0 while none is offered. Requirement ODO-13.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        super().__init__(
            {
                "edge": In(1),
                "ticks": In(STAMP_LAYOUT["ticks"].width),
                "a": In(1),
                "b": In(1),
                "overflow": Out(1),
                "stamps": Out(stream.Signature(STAMP_LAYOUT)),
            }
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        depth = self._config.stamp_depth

        held = Signal(range(depth + 1))
        lost = Signal()
        full = held == depth
        put = self.edge & ~full
        take = Signal()  # as late as the edge
        m.d.sync += take.eq(self.stamps.valid & self.stamps.ready)
        m.d.comb += self.overflow.eq(self.edge & full)
        m.d.sync += held.eq(held + put - take)
        with m.If(self.edge):
            m.d.sync += lost.eq(full)

        entry = Signal(STAMP_LAYOUT)
        m.d.comb += [
            entry.ticks.eq(self.ticks),
            entry.a.eq(self.a),
            entry.b.eq(self.b),
            entry.lost.eq(lost),
        ]
        for stage in range(self._config.stamp_latency_ticks - FIFO_TICKS - 1):
            delayed = Signal(STAMP_LAYOUT, name=f"entry_{stage}")
            delayed_put = Signal(name=f"put_{stage}")
            m.d.sync += [delayed.eq(entry), delayed_put.eq(put)]
            entry, put = delayed, delayed_put

        # Its output register comes on top of its memory: one more, so that it never refuses.
        fifo = SyncFIFOBuffered(width=STAMP_LAYOUT.size, depth=depth + 1)
        m.submodules.fifo = fifo
        m.d.comb += [
            fifo.w_en.eq(put),
            fifo.w_data.eq(entry.as_value()),
            self.stamps.valid.eq(fifo.r_rdy),
            self.stamps.payload.eq(Mux(fifo.r_rdy, fifo.r_data, 0)),
            fifo.r_en.eq(self.stamps.ready),
        ]
        return m
