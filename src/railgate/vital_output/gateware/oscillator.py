"""The peer's clock, measured with the own one by the times of its messages."""

from __future__ import annotations

from amaranth.hdl import Array, Module, Signal, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.vital_output.spec import Config

__all__ = ["MOST_STEPS", "Oscillator"]

MOST_STEPS = 3
"""A message further ahead of the last one taken is out of sequence."""


class Oscillator(wiring.Component):
    """Finds the peer's clock off its tolerance, or good over a window.

    linked: in, 1 bit, the link's state. taken: in, 1 bit, event, a message is taken. step: in, its
    number's from that of the last one taken, 1 … MOST_STEPS while linked.
    off_frequency: out, 1 bit, event, the clock is off (OSCILLATOR). drifting: out, 1 bit, register,
    it was off, and no window has passed since. Requirement DRV-17.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        super().__init__(
            {
                "linked": In(1),
                "taken": In(1),
                "step": In(range(MOST_STEPS + 1)),
                "off_frequency": Out(1),
                "drifting": Out(1),
            }
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config = self._config
        limit, period = config.drift_limit_ticks, config.link_period_ticks
        most = limit + config.lost_ticks  # without a message the link is lost
        offset = Signal(signed(1 + most.bit_length()))
        window = Signal(range(config.window_messages))

        # What offset is when a message of so many steps is taken in time; compared with each one,
        # so that the comparison need not wait for the subtraction.
        spans = [steps * period - 1 for steps in range(MOST_STEPS + 1)]
        off_by = Array((offset > span + limit) | (offset < span - limit) for span in spans)
        off = Signal.like(offset)
        passes = Signal()
        m.d.comb += [
            off.eq(offset - Array(spans)[self.step]),
            self.off_frequency.eq(self.linked & self.taken & off_by[self.step]),
            passes.eq(window + self.step >= config.window_messages),
        ]
        with m.If(self.linked):
            m.d.sync += offset.eq(offset + 1)
        with m.If(self.taken):
            m.d.sync += [offset.eq(off), window.eq(window + self.step)]
            with m.If(~self.linked | self.off_frequency | passes):
                m.d.sync += [offset.eq(0), window.eq(0)]
        with m.If(self.off_frequency):
            m.d.sync += self.drifting.eq(1)
        with m.Elif(self.linked & self.taken & passes):
            m.d.sync += self.drifting.eq(0)
        return m
