"""Everything that happens at a fixed time of the cycle."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from amaranth.hdl import Cat, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import Out

from railgate.position_link.spec import Config, Edge
from railgate.primitives import FractionalDivider, LookaheadCounter

__all__ = ["Timing"]


class BitClock(wiring.Component):
    """The edges of CLK, told `delay_ticks` late.

    marks: some of the edges by their numbers in the cycle, from 0 on; the even ones are rises.
    clk: out, 1 bit, the line. rises, falls: out, 1 bit, in the tick before such an edge. One out
    of the name of each mark, 1 bit, in the tick before this edge. All are registers.

    Its register `edge` is a tick ahead of them; `half` counts it, from edge 0 or, without delay,
    from edge 1 on, because there edge 0 is over before tick 0.
    """

    def __init__(self, config: Config, marks: Mapping[str, int], delay_ticks: int = 0) -> None:
        self._config = config
        self._marks = marks
        self._delay_ticks = delay_ticks
        self._first = first = int(delay_ticks == 0)
        super().__init__(
            {"clk": Out(1), "rises": Out(1, init=first), "falls": Out(1)}
            | {name: Out(1, init=number == 0 and first) for name, number in marks.items()}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config = self._config
        halves = Fraction(2 * config.bits, config.ticks)
        m.submodules.divider = divider = FractionalDivider(
            halves.numerator, halves.denominator, self._delay_ticks - 2
        )
        edge = Signal()
        m.d.sync += edge.eq(divider.strobe)

        edges = 2 * config.cycle_bits
        marks = {name: (at - self._first) % edges for name, at in self._marks.items()}
        m.submodules.half = half = LookaheadCounter(edges, marks)
        odd = half.value[0] ^ self._first
        m.d.comb += half.step.eq(edge)
        m.d.sync += [
            self.clk.eq(odd),
            self.rises.eq(edge & ~odd),
            self.falls.eq(edge & odd),
            *(getattr(self, name).eq(edge & getattr(half, name)) for name in marks),
        ]
        return m


class Timing(wiring.Component):
    """Bit clock and request, and the schedule of the cycle.

    All 1 bit, straight from flip-flops.
    clk, anf: out, the lines. launch: out, in the tick before CLK rises. frame_starts: out, in the
    launch of the radio frame's first bit.
    Of what was on the line input_delay_ticks before: starts: out, in the first tick of a cycle.
    early: out, from there until the window opens. open: out, the window is. closes: out, in the
    first tick after it. sample: out, in the tick of the edge with which DATA is read.
    decided: out, in the third tick after the decision, in which the reader's causes are those that
    it finds. settled: out, in the tick before `publish`. publish: out, in the tick before the
    fields change. delivery: out, in the tick in which they have changed. Requirements LNK-1, LNK-2,
    LNK-4, LNK-6.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        lines = ("clk", "anf", "launch", "frame_starts")
        line_before = ("starts", "early", "open", "closes", "sample")
        results = ("decided", "settled", "publish", "delivery")
        super().__init__({name: Out(1) for name in (*lines, *line_before, *results)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config = self._config

        marks = {
            "begins": 0,
            "request_ends": 2 * config.request_bits,
            "frame_starts": 2 * config.radio_first,
        }
        m.submodules.now = now = BitClock(config, marks)
        m.d.comb += [
            self.clk.eq(now.clk),
            self.launch.eq(now.rises),
            self.frame_starts.eq(now.frame_starts),
        ]
        m.d.sync += self.anf.eq(now.begins | (self.anf & ~now.request_ends))

        marks = {
            "starts": 0,
            "opens": 2 * (config.earliest_clk - 1),
            "closes": 2 * config.window_bits,
            "decides": 2 * (config.window_bits + config.word_bits + 1),
        }
        m.submodules.delayed = delayed = BitClock(config, marks, config.input_delay_ticks)
        falling = config.sampling_edge is Edge.FALLING
        m.d.sync += [
            self.starts.eq(delayed.starts),
            self.closes.eq(delayed.closes),
            self.sample.eq(delayed.falls if falling else delayed.rises),
            self.early.eq((delayed.starts | self.early) & ~delayed.opens),
            self.open.eq((delayed.opens | self.open) & ~delayed.closes),
        ]

        since_decision = Signal(config.delivery_latency_ticks + 1)  # bit n: n ticks ago
        m.d.sync += since_decision.eq(Cat(delayed.decides, since_decision))
        m.d.comb += [
            self.decided.eq(since_decision[3]),
            self.settled.eq(since_decision[-3]),
            self.publish.eq(since_decision[-2]),
            self.delivery.eq(since_decision[-1]),
        ]
        return m
