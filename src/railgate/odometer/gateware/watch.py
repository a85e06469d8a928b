"""The watch over both channels: one that lags behind, one that is gone."""

from __future__ import annotations

from amaranth.hdl import Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.odometer.gateware.steps import Elapsed
from railgate.odometer.spec import Config

__all__ = ["Watch"]


class Watch(wiring.Component):
    """Counts the rising edges of each channel since one of the other.

    a_rise, b_rise: in, 1 bit. judged, watched: in, 1 bit, a clean period closes in this tick, and
    it is no longer than watch_ticks.
    mismatch, a_missing, b_missing: out, 1 bit, in the tick of the edge that shows it.
    Requirement ODO-12.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        super().__init__(
            {name: In(1) for name in ("a_rise", "b_rise", "judged", "watched")}
            | {name: Out(1) for name in ("mismatch", "a_missing", "b_missing")}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config = self._config

        rise = self.a_rise | self.b_rise
        m.submodules.since_either = since_either = Elapsed(config.watch_ticks + 1)
        m.d.comb += since_either.restart.eq(rise)
        late = rise & (since_either.now > config.watch_ticks)

        armed = Signal()
        armed_now = Mux(self.judged, self.watched, armed & ~late)
        m.d.sync += armed.eq(armed_now)

        mismatches = []
        for name, own, other, missing in (
            ("a", self.a_rise, self.b_rise, self.b_missing),
            ("b", self.b_rise, self.a_rise, self.a_missing),
        ):
            run = Signal(range(config.missing_pulses + 1), name=f"run_{name}")
            run_now = Signal.like(run, name=f"run_{name}_now")
            full = (run == config.missing_pulses) & ~late
            m.d.comb += run_now.eq(Mux(full, run, Mux(late, 0, run) + 1))
            alone = own & ~other
            with m.If(alone):
                m.d.sync += run.eq(run_now)
            with m.Elif(rise):
                m.d.sync += run.eq(0)
            m.d.comb += missing.eq(alone & (run_now == config.missing_pulses))
            mismatches.append(alone & armed_now & (run_now >= 2))
        m.d.comb += self.mismatch.eq(mismatches[0] | mismatches[1])
        return m
