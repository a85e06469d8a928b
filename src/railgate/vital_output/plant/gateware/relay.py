"""The relays, each with its two dynamic stages in series."""

from __future__ import annotations

from amaranth.hdl import Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.wiring import In, Out

from railgate.vital_output.plant.relay import DEFECTS, RelayTimes, Stage
from railgate.vital_output.spec import Config

__all__ = ["Relay"]


class DynamicStage(wiring.Component):
    """Tells whether a train of the right period comes in.

    source: in, 1 bit, asynchronous. alive: out, 1 bit.
    """

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        super().__init__({"source": In(1), "alive": Out(1)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        low, high = self._stage.low, self._stage.high
        seen, before, rise = Signal(), Signal(), Signal()
        m.submodules.synchroniser = FFSynchronizer(self.source, seen, reset_less=False)
        m.d.sync += before.eq(seen)
        m.d.comb += rise.eq(seen & ~before)

        since = Signal(range(high + 2), init=high + 1)
        with m.If(rise):
            m.d.sync += [since.eq(1), self.alive.eq((since >= low) & (since <= high))]
        with m.Else():
            m.d.sync += since.eq(since + (since <= high))
            with m.If(since >= high):
                m.d.sync += self.alive.eq(0)
        return m


class Relay(wiring.Component):
    """The relays of all outputs, bit i of each port is output i's.

    pulses_1, pulses_2: in, of FPGA 1 and 2. welded, broken, rogue_1, rogue_2: in, what is wrong.
    contact: out, 1 where it is closed. All are `outputs` bits. Requirement DRV-13.
    """

    def __init__(self, config: Config, times: RelayTimes) -> None:
        self._stage = Stage.of(config, times)
        self._times = times
        inputs = ("pulses_1", "pulses_2", *DEFECTS)
        super().__init__(
            {name: In(config.outputs) for name in inputs} | {"contact": Out(config.outputs)}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        train = self._train(m)
        for i in range(len(self.contact)):
            alive = []
            for c, pulses, rogue in (
                (1, self.pulses_1, self.rogue_1),
                (2, self.pulses_2, self.rogue_2),
            ):
                m.submodules[f"stage_{i}_{c}"] = stage = DynamicStage(self._stage)
                m.d.comb += stage.source.eq(Mux(rogue[i], train, pulses[i]))
                alive.append(stage.alive)
            coil = alive[0] & alive[1] & ~self.broken[i]
            self._move(m, i, coil)
        return m

    def _train(self, m: Module) -> Value:
        """The train of a faulty FPGA, which pulses for ever."""
        period = self._stage.period
        tick = Signal(range(period))
        m.d.sync += tick.eq(Mux(tick == period - 1, 0, tick + 1))
        return tick < period // 2

    def _move(self, m: Module, i: int, coil: Value) -> None:
        """Contact i follows its coil, pick-up or release later."""
        contact = self.contact[i]
        pick_up, release = self._times.pick_up_ticks, self._times.release_ticks
        moving = Signal(range(max(pick_up, release)), name=f"moving_{i}")
        last = moving >= Mux(contact, release, pick_up) - 1
        m.d.sync += moving.eq(0)
        with m.If(coil != contact):
            with m.If(~last):
                m.d.sync += moving.eq(moving + 1)
            with m.Elif(contact & self.welded[i]):
                m.d.sync += moving.eq(moving)
            with m.Else():
                m.d.sync += contact.eq(coil)
