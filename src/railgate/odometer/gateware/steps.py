"""From filtered levels to steps of a quarter pitch, and ticks since an event."""

from __future__ import annotations

from amaranth.hdl import Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.odometer.spec import Direction
from railgate.primitives.chunked import count, delayed, state_bits

__all__ = ["Elapsed", "Steps"]


class Elapsed(wiring.Component):
    """Ticks since an event, that stay at the greatest value of `width` bits.

    restart: in, 1 bit, the event. now: out, register, ticks since the last event before this tick.
    full: out, 1 bit, register, `now` is its greatest value. ticks: out, register, `now` as it
    stood after the tick before, so 0 after an event. reaches: out, 1 bit, `full` for the first time.
    state: out, all that the counter `now` consists of.
    """

    def __init__(self, width: int) -> None:
        super().__init__(
            {
                "restart": In(1),
                "now": Out(width),
                "full": Out(1),
                "ticks": Out(width),
                "reaches": Out(1),
                "state": Out(state_bits(width)),
            }
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        now = count(m, self.now, clear=self.restart, saturates=True)
        m.d.sync += self.ticks.eq(Mux(self.restart, 0, self.now))
        m.d.comb += [
            self.full.eq(now.full),
            self.state.eq(now.state),
            self.reaches.eq(now.full & ~delayed(m, now.full, 1, name="was_full")),
        ]
        return m


class Steps(wiring.Component):
    """Quadrature decoder: forward is (a, b) = 00 → 10 → 11 → 01 → 00.

    a, b: in, 1 bit, the levels after this tick's edges. a_edge, b_edge: in, 1 bit.
    forward, reverse, illegal: out, 1 bit, registers, what the edges of two ticks ago are. reversal:
    out, 1 bit, register, a step against the direction. broken: out, 1 bit, register, a reversal or
    illegal. direction: out, 2 bits, register, of the last step, see Direction; NONE after an
    illegal transition; it is new in the tick after the step. Requirements ODO-5, ODO-6.
    """

    def __init__(self) -> None:
        inputs = ("a", "b", "a_edge", "b_edge")
        events = ("forward", "reverse", "illegal", "reversal", "broken")
        super().__init__(
            {name: In(1) for name in inputs}
            | {name: Out(1) for name in events}
            | {"direction": Out(2)}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        forward, reverse, illegal = Signal(), Signal(), Signal()
        step = self.a_edge ^ self.b_edge
        leads = self.a ^ self.b ^ self.b_edge  # a moves away from b, or b follows a
        m.d.sync += [
            forward.eq(step & leads),
            reverse.eq(step & ~leads),
            illegal.eq(self.a_edge & self.b_edge),
        ]
        heading = Signal(2)
        reversal = (forward & (heading == Direction.REVERSE)) | (
            reverse & (heading == Direction.FORWARD)
        )
        with m.If(forward):
            m.d.sync += heading.eq(Direction.FORWARD)
        with m.Elif(reverse):
            m.d.sync += heading.eq(Direction.REVERSE)
        with m.Elif(illegal):
            m.d.sync += heading.eq(Direction.NONE)
        m.d.sync += [
            self.forward.eq(forward),
            self.reverse.eq(reverse),
            self.illegal.eq(illegal),
            self.reversal.eq(reversal),
            self.broken.eq(reversal | illegal),
            self.direction.eq(heading),
        ]
        return m
