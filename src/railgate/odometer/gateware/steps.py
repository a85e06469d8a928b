"""From filtered levels to steps of a quarter pitch, and ticks since edges."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.odometer.spec import Direction
from railgate.primitives.chunked import count

__all__ = ["Ages", "Steps"]


class Ages(wiring.Component):
    """Ticks since the last edge and since the boundary, which is some edge before or that one.

    Two counters, that stay at the greatest value of `width` bits: where the boundary moves, it
    moves to the last edge, whose counter is then its own too, and the next edge takes the other.

    edge_soon: in, 1 bit, there is an edge in the next tick. moves_soon: in, 1 bit, the boundary of
    the next tick is the last edge before it. tick_0_soon: in, 1 bit, that is tick 0, or before.
    last, boundary: out, ticks since the one before this tick. last_full, boundary_full: out, 1 bit,
    it is their greatest value. since_last: out, register, `last` as it stood after the tick before,
    so 0 after an edge. restarts: out, 1 bit, register, there is an edge, or it is tick 0.
    """

    def __init__(self, width: int) -> None:
        super().__init__(
            {name: In(1) for name in ("edge_soon", "moves_soon", "tick_0_soon")}
            | {name: Out(width) for name in ("last", "boundary", "since_last")}
            | {name: Out(1) for name in ("last_full", "boundary_full")}
            | {"restarts": Out(1, init=1)}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        # Which counter is whose.
        newest, last, boundary = (
            Signal(name=f"{name}_which") for name in ("newest", "last", "boundary")
        )
        boundary_soon = Mux(self.moves_soon, newest, boundary)
        m.d.sync += [boundary.eq(boundary_soon), last.eq(newest)]
        with m.If(self.edge_soon):
            m.d.sync += newest.eq(~boundary_soon)

        ages, full = [], []
        for which in range(2):
            age = Signal.like(self.last, init=1, reset_less=True, name=f"age_{which}")
            restart = Signal(init=1, name=f"restart_{which}")
            m.d.sync += restart.eq((self.edge_soon & (boundary_soon != which)) | self.tick_0_soon)
            ages.append(age)
            full.append(count(m, age, restart=restart, saturates=True))
        since_last = Signal.like(self.since_last, reset_less=True)
        m.d.sync += [
            self.restarts.eq(self.edge_soon | self.tick_0_soon),
            since_last.eq(Mux(self.restarts, 0, self.last)),
        ]
        m.d.comb += [
            self.since_last.eq(since_last),
            self.last.eq(Mux(last, *ages[::-1])),
            self.last_full.eq(Mux(last, *full[::-1])),
            self.boundary.eq(Mux(boundary, *ages[::-1])),
            self.boundary_full.eq(Mux(boundary, *full[::-1])),
        ]
        return m


class Steps(wiring.Component):
    """Quadrature decoder: forward is (a, b) = 00 → 10 → 11 → 01 → 00.

    a, b: in, 1 bit, the levels after this tick's edges. a_edge, b_edge: in, 1 bit.
    step: out, 2 bits, signed, register, 1 forward and - 1 in reverse, of the edges of two ticks
    ago. illegal, reversal, broken: out, 1 bit, registers, as late: two edges at once, a step
    against the direction, either of these. direction: out, 2 bits, register, of the last step, see
    Direction; NONE after an illegal transition; it is new in the tick after the step.
    Requirements ODO-5, ODO-6.
    """

    def __init__(self) -> None:
        inputs = ("a", "b", "a_edge", "b_edge")
        events = ("illegal", "reversal", "broken")
        super().__init__(
            {name: In(1) for name in inputs}
            | {name: Out(1) for name in events}
            | {"step": Out(signed(2)), "direction": Out(2)}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        forward, reverse, illegal = (
            Signal(name=f"{name}_soon") for name in ("forward", "reverse", "illegal")
        )
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
            self.step.eq(Cat(forward | reverse, reverse)),
            self.illegal.eq(illegal),
            self.reversal.eq(reversal),
            self.broken.eq(reversal | illegal),
            self.direction.eq(heading),
        ]
        return m
