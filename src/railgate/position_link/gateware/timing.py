"""Everything that happens at a fixed time of the cycle."""

from __future__ import annotations

from fractions import Fraction

from amaranth.hdl import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import Out

from railgate.position_link.spec import Config, Edge
from railgate.primitives import FractionalDivider, OneShot

__all__ = ["Timing"]


class BitClock(wiring.Component):
    """The edges of CLK, counted through the cycles and told `delay_ticks` late.

    edge: out, 1 bit, in the tick before that of an edge. half: out, register, the number of edges
    before it in its cycle: it is an odd number if and only if CLK is high.
    """

    def __init__(self, config: Config, delay_ticks: int = 0) -> None:
        self._config = config
        self._delay_ticks = delay_ticks
        super().__init__({"edge": Out(1), "half": Out(range(2 * config.cycle_bits))})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config = self._config
        halves = Fraction(2 * config.bits, config.ticks)
        m.submodules.divider = divider = FractionalDivider(
            halves.numerator, halves.denominator, self._delay_ticks
        )
        m.d.comb += self.edge.eq(divider.strobe)
        with m.If(self.edge):
            m.d.sync += self.half.eq(self.half + 1)
            with m.If(self.half == 2 * config.cycle_bits - 1):
                m.d.sync += self.half.eq(0)
        return m


class Timing(wiring.Component):
    """Bit clock and request, and the schedule of the cycle.

    All 1 bit, those with * straight from flip-flops.
    clk*, anf*: out, the lines. launch: out, in the tick before CLK rises. frame_starts: out, in
    the launch of the radio frame's first bit.
    Of what was on the line input_delay_ticks before: starts*: out, in the first tick of a cycle.
    early*: out, from there until the window opens. open*: out, the window is. closes*: out, in the
    first tick after it. sample*: out, in the tick of the edge with which DATA is read.
    decided: out, in the tick after the decision, in which the registers hold what it finds; what
    happens in this tick belongs to the next. publish: out, in the tick before the fields change.
    delivery*: out, in the tick in which they have changed. Requirements LNK-1, LNK-2, LNK-4, LNK-6.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        lines = ("clk", "anf", "launch", "frame_starts")
        line_before = ("starts", "early", "open", "closes", "sample")
        results = ("decided", "publish", "delivery")
        super().__init__({name: Out(1) for name in (*lines, *line_before, *results)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config = self._config

        m.submodules.now = now = BitClock(config)
        m.d.comb += [
            self.clk.eq(now.half[0]),
            self.launch.eq(now.edge & ~now.half[0]),
            self.frame_starts.eq(now.edge & (now.half == 2 * config.radio_first)),
        ]
        with m.If(now.edge & (now.half == 0)):
            m.d.sync += self.anf.eq(1)
        with m.If(now.edge & (now.half == 2 * config.request_bits)):
            m.d.sync += self.anf.eq(0)

        m.submodules.delayed = delayed = BitClock(config, config.input_delay_ticks)
        starts = delayed.edge & (delayed.half == 0)
        opens = delayed.edge & (delayed.half == 2 * (config.earliest_clk - 1))
        closes = delayed.edge & (delayed.half == 2 * config.window_bits)
        decides = delayed.edge & (delayed.half == 2 * (config.window_bits + config.word_bits + 1))
        falls = delayed.half[0]
        m.d.sync += [
            self.starts.eq(starts),
            self.closes.eq(closes),
            self.sample.eq(
                delayed.edge & (falls if config.sampling_edge is Edge.FALLING else ~falls)
            ),
        ]
        with m.If(starts):
            m.d.sync += self.early.eq(1)
        with m.If(opens):
            m.d.sync += [self.early.eq(0), self.open.eq(1)]
        with m.If(closes):
            m.d.sync += self.open.eq(0)

        latency = config.delivery_latency_ticks
        m.submodules.until_delivery = until_delivery = OneShot(latency)
        m.d.comb += [
            until_delivery.trigger.eq(decides),
            self.decided.eq(until_delivery.remaining == latency - 1),
            self.publish.eq(until_delivery.remaining == 1),
        ]
        m.d.sync += self.delivery.eq(self.publish)
        return m
