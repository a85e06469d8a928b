"""The measurement window: periods and sums between two snapshots."""

from __future__ import annotations

from amaranth.hdl import Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.odometer.spec import Config

__all__ = ["Window"]


class Window(wiring.Component):
    """Number of periods, first-to-last ticks and the two nested sums, from a boundary edge on.

    a_rise: in, 1 bit. broken: in, 1 bit, a reversal or an illegal transition. latch: in, 1 bit, in
    the tick after the strobe, in which the registers hold what it latches: the last edge becomes
    the boundary before this tick's own events. since_rise: in, ticks since the last rising edge of
    a as they stood after the tick before.
    window_seated, window_n, window_ticks, sum_a, sum_b: out, registers, the fields of that name.
    saturated, overflow, void: out, 1 bit, why and that a seated window is lost in this tick.
    Requirement ODO-10.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        super().__init__(
            {
                "a_rise": In(1),
                "broken": In(1),
                "latch": In(1),
                "since_rise": In(config.period_bits),
                "window_seated": Out(1),
                "window_n": Out(config.window_bits),
                "window_ticks": Out(config.period_bits),
                "sum_a": Out(config.sum_a_bits),
                "sum_b": Out(config.sum_b_bits),
                "saturated": Out(1),
                "overflow": Out(1),
                "void": Out(1),
            }
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config = self._config

        n = Mux(self.latch, 0, self.window_n)
        sum_a = Mux(self.latch, 0, self.sum_a)
        sum_b = Mux(self.latch, 0, self.sum_b)
        # Of a seated window without periods the boundary is the last edge already.
        elapsed = Signal(config.period_bits)
        now = Signal(config.period_bits)
        m.d.comb += now.eq(Mux(self.latch, self.since_rise, elapsed) + 1)
        m.d.sync += elapsed.eq(now)

        m.d.comb += self.saturated.eq(self.window_seated & (now == config.period_max))
        lost = self.saturated | (self.window_seated & self.broken)
        goes_on = self.window_seated & ~lost
        m.d.comb += [
            self.overflow.eq(self.a_rise & goes_on & (n == config.window_pulses)),
            self.void.eq(lost | self.overflow),
        ]

        fields = (self.window_n, self.window_ticks, self.sum_a, self.sum_b)
        with m.If(self.latch | self.void):
            m.d.sync += [field.eq(0) for field in fields]
        with m.If(lost):
            m.d.sync += self.window_seated.eq(0)
        with m.If(self.a_rise):
            with m.If(goes_on & ~self.overflow):
                m.d.sync += [
                    self.window_n.eq(n + 1),
                    self.window_ticks.eq(now),
                    self.sum_a.eq(sum_a + now),
                    self.sum_b.eq(sum_b + sum_a + now),
                ]
            with m.Else():
                m.d.sync += [self.window_seated.eq(1), elapsed.eq(0)]
        return m
