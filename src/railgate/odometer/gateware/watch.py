"""The watch over both channels: one that lags behind, one that is gone."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.odometer.spec import Config
from railgate.primitives.chunked import count, delayed, exceeds

__all__ = ["Watch"]


class Watch(wiring.Component):
    """Counts the rising edges of each channel since one of the other.

    restart: in, 1 bit, tick 0 or a rising edge of either. a_rise, b_rise: in, 1 bit. judged,
    watched: in, 1 bit, a clean period was closed a tick before, and is no longer than watch_ticks.
    a_missing, b_missing: out, 1 bit, in the tick after the edge that shows it. mismatch: out, 1
    bit, two ticks after it.
    Requirement ODO-12.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        inputs = ("restart", "a_rise", "b_rise", "judged", "watched")
        super().__init__(
            {name: In(1) for name in inputs}
            | {name: Out(1) for name in ("mismatch", "a_missing", "b_missing")}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config = self._config

        since_either = Signal(range(config.watch_ticks + 1), init=1, reset_less=True)
        count(m, since_either, restart=self.restart)
        over = exceeds(m, since_either, config.watch_ticks, restart=self.restart)
        rise = Signal()
        late = Signal()
        m.d.sync += [
            rise.eq(self.a_rise | self.b_rise),
            late.eq((self.a_rise | self.b_rise) & over),
        ]

        armed = Signal()
        m.d.sync += armed.eq(Mux(self.judged, self.watched, armed & ~late))

        second = []
        for name, own, other, missing in (
            ("a", self.a_rise, self.b_rise, self.b_missing),
            ("b", self.b_rise, self.a_rise, self.a_missing),
        ):
            alone = Signal(name=f"{name}_alone")
            run = Signal(config.missing_pulses, name=f"run_{name}")  # as many ones as edges
            m.d.sync += alone.eq(own & ~other)
            with m.If(alone):
                m.d.sync += run.eq(Cat(1, Mux(late, 0, run)))
            with m.Elif(rise):
                m.d.sync += run.eq(0)
            m.d.comb += missing.eq(alone & ~late & run[-2])
            second.append(alone & ~late & run[0])
        m.d.comb += self.mismatch.eq(delayed(m, Cat(second).any(), 1, name="second") & armed)
        return m
