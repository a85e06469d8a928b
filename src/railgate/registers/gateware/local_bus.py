"""A bridge from an asynchronous memory bus, as the local bus of a PowerPC is one."""

from __future__ import annotations

from amaranth.hdl import Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.wiring import In, Out

from railgate.registers.gateware.access import INDEX_FROM
from railgate.registers.gateware.bus import bus_signature
from railgate.registers.register import WORD_BITS

__all__ = ["LocalBus"]

HALF_BITS = WORD_BITS // 2


class LocalBus(wiring.Component):
    """A memory of 16 or 32 data bits to a processor whose clock is not the bus's; in domain sync.

    Pins, active low, asynchronous: cs_n, oe_n: in, 1 bit; we_n: in, one bit a byte, bit 0 of the
    least significant one. address: in, bytes. data_in: in; data_out: out, and data_oe: out, 1 bit,
    the pins are driven: straight from cs_n and oe_n, so that they are free as soon as these rise.
    ready_n: out, 1 bit, transfer acknowledge; error_n: out, 1 bit, low along with it if the bus
    told an error. bus: out, see bus_signature.

    A read is cs_n and oe_n low, a write is cs_n and any we_n low; the other one stays high. The
    lanes of we_n fall within 1 tick. From 1 tick after the last of these pins has fallen, address,
    and of a write data, stand still; all stay until ready_n is low. It falls at most 6 ticks after
    the last of them has, and the bus's own ticks later; after any of them has risen it rises within
    3 ticks, and the next access must not begin before.

    Bytes are in the order of a PowerPC, the most significant one at the lowest address. Of 16 data
    bits, a word is two accesses, to the lower address first: a read of it reads the word, of which
    the one to the higher address gets what is left; a write of it is kept until the one to the
    higher address writes the word. An access to a higher address that does not follow its own lower
    one is an error.
    """

    def __init__(self, address_bits: int, data_bits: int = WORD_BITS) -> None:
        if data_bits not in (HALF_BITS, WORD_BITS):
            raise ValueError(f"data_bits must be {HALF_BITS} or {WORD_BITS}, not {data_bits}")
        self._data_bits = data_bits
        super().__init__(
            {
                "cs_n": In(1, init=1),
                "oe_n": In(1, init=1),
                "we_n": In(data_bits // 8, init=~0),
                "address": In(address_bits),
                "data_in": In(data_bits),
                "data_out": Out(data_bits),
                "data_oe": Out(1),
                "ready_n": Out(1, init=1),
                "error_n": Out(1, init=1),
                "bus": Out(bus_signature(address_bits)),
            }
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        request, response = self.bus.request, self.bus.response
        selected, reads, lanes = Signal(), Signal(), Signal(self._data_bits // 8)
        for name, pin, level in (
            ("select", self.cs_n, selected),
            ("read", self.oe_n, reads),
            ("write", self.we_n, lanes),
        ):
            m.submodules[name] = FFSynchronizer(~pin, level)
        active = selected & (reads | lanes.any())

        error, kept, word = Signal(), Signal(), Signal(WORD_BITS)
        m.d.comb += self.data_oe.eq(~self.cs_n & ~self.oe_n)
        m.d.sync += [self.ready_n.eq(1), self.error_n.eq(1)]
        with m.FSM():
            with m.State("IDLE"), m.If(active):
                m.next = "SETTLES"  # by the next tick all lanes have come through
            with m.State("SETTLES"):
                m.d.sync += error.eq(0)
                if self._data_bits == WORD_BITS:
                    m.d.sync += [
                        request.p.address.eq(self.address),
                        request.p.write.eq(~reads),
                        request.p.data.eq(self.data_in),
                        request.p.strobes.eq(lanes),
                    ]
                    m.next = "ASKS"
                else:
                    self._half(m, reads, lanes, kept, error)
            with m.State("ASKS"):
                m.d.comb += request.valid.eq(1)
                with m.If(request.ready):
                    m.next = "WAITS"
            with m.State("WAITS"), m.If(response.valid):
                m.d.sync += [
                    error.eq(response.error),
                    kept.eq(~request.p.write),
                    word.eq(response.data),
                ]
                m.next = "READY"
            with m.State("READY"):
                m.d.sync += [self.ready_n.eq(~active), self.error_n.eq(~(active & error))]
                with m.If(~active):
                    m.next = "IDLE"
        lower = self.address[1]
        halves = Mux(lower, word[:HALF_BITS], word[HALF_BITS:])
        m.d.comb += self.data_out.eq(word if self._data_bits == WORD_BITS else halves)
        return m

    def _half(self, m: Module, reads: Value, lanes: Value, kept: Value, error: Value) -> None:
        """What one of two accesses does: `kept` is 1 from its first one to its last."""
        asked = self.bus.request.p
        with m.If(~self.address[1]):
            m.d.sync += [
                asked.address.eq(self.address),
                asked.write.eq(~reads),
                asked.data.eq(self.data_in << HALF_BITS),
                asked.strobes.eq(lanes << len(lanes)),
                kept.eq(~reads),
            ]
            m.next = "ASKS"
            with m.If(~reads):
                m.next = "READY"
        with m.Elif(
            kept
            & (asked.address[INDEX_FROM:] == self.address[INDEX_FROM:])
            & (asked.write == ~reads)
        ):
            m.next = "READY"
            with m.If(~reads):
                m.d.sync += [
                    asked.data[:HALF_BITS].eq(self.data_in),
                    asked.strobes[: len(lanes)].eq(lanes),
                    kept.eq(0),
                ]
                m.next = "ASKS"
        with m.Else():
            m.d.sync += error.eq(1)
            m.next = "READY"
