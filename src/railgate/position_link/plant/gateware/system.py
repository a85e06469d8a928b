"""The position system with its cable."""

from __future__ import annotations

from amaranth.hdl import Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out

from railgate.position_link.plant.plan import DELAY_BITS, behaviour
from railgate.position_link.spec import Config, Edge

__all__ = ["PositionSystem"]


class PositionSystem(wiring.Component):
    """Answers a request as it is told.

    clk, anf: in, 1 bit, the link's. behaviour: what it does, all in, see plan.behaviour.
    uef, data: out, 1 bit, at the far end of its cable. Requirements LNK-2 … LNK-4.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        told = {name: In(width) for name, width in behaviour(config).items()}
        super().__init__(
            {
                "clk": In(1),
                "anf": In(1),
                "behaviour": Out(wiring.Signature(told)),
                "uef": Out(1),
                "data": Out(1),
            }
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        number, launch = self._clk_number(m)
        told = self.behaviour
        uef, data = Signal(), Signal()
        left = Signal.like(told.length)
        rest = Signal.like(told.word)

        def begins(latency: Signal, length: Signal) -> Value:
            return (latency != 0) & (length != 0) & (number == latency)

        first = begins(told.latency, told.length)
        with m.If(launch):
            with m.If(first | begins(told.second, told.second_length)):
                m.d.sync += [
                    left.eq(Mux(first, told.length, told.second_length) - 1),
                    rest.eq(told.word << 1),
                    uef.eq(1),
                    data.eq(told.word[-1]),
                ]
            with m.Elif((number > 1) & (left != 0)):
                m.d.sync += [left.eq(left - 1), rest.eq(rest << 1), data.eq(rest[-1])]
            with m.Else():
                m.d.sync += [left.eq(0), uef.eq(0), data.eq(0)]
        self._cable(m, uef, data)
        return m

    def _clk_number(self, m: Module) -> tuple[Signal, Signal]:
        """The number of CLK in this tick, and whether an edge that launches is seen in it."""
        held = Signal(range(self._config.cycle_bits + 1))
        number = Signal.like(held)
        before, requested = Signal(), Signal()
        rise, fall = self.clk & ~before, ~self.clk & before
        m.d.sync += [before.eq(self.clk), held.eq(number)]
        m.d.comb += number.eq(held)
        with m.If(rise):
            m.d.sync += requested.eq(self.anf)
            with m.If(self.anf & ~requested):
                m.d.comb += number.eq(1)
            with m.Elif(held == self._config.cycle_bits):
                m.d.comb += number.eq(0)
            with m.Elif(held != 0):
                m.d.comb += number.eq(held + 1)
        launch = Signal()
        m.d.comb += launch.eq(rise if self._config.sampling_edge == Edge.FALLING else fall)
        return number, launch

    def _cable(self, m: Module, uef: Signal, data: Signal) -> None:
        """What was launched `delay` ticks ago; the memory keeps its content over a reset."""
        depth = 1 << DELAY_BITS
        m.submodules.cable = cable = Memory(shape=2, depth=depth, init=[])
        write, read = cable.write_port(), cable.read_port(domain="comb")
        tick, age = Signal(DELAY_BITS), Signal(range(depth))
        delay = self.behaviour.delay
        m.d.sync += [tick.eq(tick + 1), age.eq(age + (age != depth - 1))]
        m.d.comb += [
            write.en.eq(1),
            write.addr.eq(tick),
            write.data.eq(uef << 1 | data),
            read.addr.eq(tick - delay),
        ]
        with m.If(delay == 0):
            m.d.comb += [self.uef.eq(uef), self.data.eq(data)]
        with m.Elif(delay <= age):
            m.d.comb += [self.uef.eq(read.data[1]), self.data.eq(read.data[0])]
