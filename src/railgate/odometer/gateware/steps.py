"""From filtered levels to steps of a quarter pitch, and ticks since an event."""

from __future__ import annotations

from amaranth.hdl import Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.odometer.spec import Direction

__all__ = ["Elapsed", "Steps"]


class Elapsed(wiring.Component):
    """Ticks since an event, or since reset, that stay at `limit`.

    restart: in, 1 bit, the event. now: out, ticks since the last event before this tick.
    ticks: out, register, the same as it stood after the tick before, so 0 after an event.
    reaches: out, 1 bit, `now` is `limit` for the first time.
    """

    def __init__(self, limit: int) -> None:
        self._limit = limit
        width = limit.bit_length()
        super().__init__(
            {"restart": In(1), "now": Out(width), "ticks": Out(width), "reaches": Out(1)}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        started = Signal()  # tick 0 itself is no tick after it
        full = self.ticks == self._limit
        m.d.comb += [
            self.now.eq(Mux(full, self._limit, self.ticks + started)),
            self.reaches.eq((self.now == self._limit) & ~full),
        ]
        m.d.sync += [started.eq(1), self.ticks.eq(Mux(self.restart, 0, self.now))]
        return m


class Steps(wiring.Component):
    """Quadrature decoder: forward is (a, b) = 00 → 10 → 11 → 01 → 00.

    a, b: in, 1 bit, the levels after this tick's edges. a_edge, b_edge: in, 1 bit.
    forward, reverse, illegal: out, 1 bit, what this tick's edges are. reversal: out, 1 bit, a step
    against `direction`. direction: out, 2 bits, register, of the last step, see Direction; NONE
    after an illegal transition. Requirements ODO-5, ODO-6.
    """

    def __init__(self) -> None:
        inputs = ("a", "b", "a_edge", "b_edge")
        events = ("forward", "reverse", "illegal", "reversal")
        super().__init__(
            {name: In(1) for name in inputs}
            | {name: Out(1) for name in events}
            | {"direction": Out(2)}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        step = self.a_edge ^ self.b_edge
        leads = self.a ^ self.b ^ self.b_edge  # a moves away from b, or b follows a
        m.d.comb += [
            self.forward.eq(step & leads),
            self.reverse.eq(step & ~leads),
            self.illegal.eq(self.a_edge & self.b_edge),
            self.reversal.eq(
                (self.forward & (self.direction == Direction.REVERSE))
                | (self.reverse & (self.direction == Direction.FORWARD))
            ),
        ]
        with m.If(self.forward):
            m.d.sync += self.direction.eq(Direction.FORWARD)
        with m.Elif(self.reverse):
            m.d.sync += self.direction.eq(Direction.REVERSE)
        with m.Elif(self.illegal):
            m.d.sync += self.direction.eq(Direction.NONE)
        return m
