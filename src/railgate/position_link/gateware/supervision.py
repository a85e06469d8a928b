"""What a verdict makes of the link: its state and counts, and the fields of the delivery."""

from __future__ import annotations

from amaranth.hdl import Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.position_link.spec import Cause, Config, Health, Status

__all__ = ["Supervision"]


class Supervision(wiring.Component):
    """Brings the link up and down, counts, and holds the fields between two deliveries.

    publish: in, 1 bit, in the tick before the fields change. good, found: in, see Verdict (there
    `causes`); two ticks before `publish` they stand. read, since_rise: in, see Reader (there
    `word`). uef_glitch, data_glitch: in, 1 bit each, rejected in this tick.
    One out of each of config.fields, registers. Requirements LNK-5, LNK-6, LNK-7.

    The fields themselves are the state: the link is down where status is FAULT, and up in HELD the
    word is that of the last good cycle.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        inputs = ("publish", "good", "uef_glitch", "data_glitch")
        super().__init__(
            {name: In(1) for name in inputs}
            | {
                "found": In(len(Cause)),
                "read": In(config.word_bits),
                "since_rise": In(range(config.delivery_ticks + 1)),
            }
            | {field.name: Out(field.width, init=field.start) for field in config.fields}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config = self._config

        up = self.status != Status.FAULT
        run = Signal(range(max(config.tolerated_cycles, config.recovery_cycles)))
        last = Mux(up, config.tolerated_cycles - 1, config.recovery_cycles - 1)
        against = up ^ self.good  # faulty while up, good while down: `run` of them before
        turns = Signal()
        m.d.sync += turns.eq(against & (run == last))
        up_next = up ^ turns
        with m.If(self.publish):
            m.d.sync += run.eq(Mux(against & ~turns, run + 1, 0))

        # In START all deliveries so far were of faulty cycles.
        first_turn = self.number == config.tolerated_cycles - 1
        with m.If(self.publish & ~up_next):
            m.d.sync += [
                self.status.eq(Status.FAULT),
                self.word.eq(config.invalid_word),
            ]
            with m.If(self.good):
                m.d.sync += self.health.eq(Health.RECOVERING)
            with m.Elif((self.health != Health.START) | first_turn):
                m.d.sync += self.health.eq(Health.ALARM)
        with m.Elif(self.publish & self.good):
            m.d.sync += [
                self.status.eq(Status.FRESH),
                self.word.eq(self.read),
                self.health.eq(Health.OK),
            ]
        with m.Elif(self.publish):
            m.d.sync += [self.status.eq(Status.HELD), self.health.eq(Health.WARNING)]

        with m.If(self.publish):
            m.d.sync += [
                self.number.eq(self.number + 1),
                self.causes.eq(self.found),
                self.faulty_cycles.eq(self.faulty_cycles + ~self.good),
            ]
            for index, cause in enumerate(Cause):
                count = getattr(self, f"{cause.name}_cycles".lower())
                m.d.sync += count.eq(count + self.found[index])

        self._age(m)
        self._glitches(m)
        return m

    def _age(self, m: Module) -> None:
        """The age in cycles and in ticks; from one delivery to the next these are cycle_ticks."""
        never, old = (1 << len(self.age)) - 1, (1 << len(self.age_ticks)) - 1
        too_old = Signal()
        m.d.sync += too_old.eq(self.age_ticks > old - self._config.cycle_ticks)
        with m.If(self.publish & self.good):
            since_rise = Mux(self.since_rise > old, old, self.since_rise)
            m.d.sync += [self.age.eq(0), self.age_ticks.eq(since_rise)]
        with m.Elif(self.publish):
            older = self.age_ticks + self._config.cycle_ticks
            m.d.sync += [
                self.age.eq(Mux(self.age == never, never, self.age + 1)),
                self.age_ticks.eq(Mux(too_old, old, older)),
            ]

    def _glitches(self, m: Module) -> None:
        """Counts each so late that, when the fields change, those up to the decision are in."""
        late = self.uef_glitch + self.data_glitch
        for stage in range(self._config.delivery_latency_ticks - 2):
            later = Signal.like(late, name=f"glitches_{stage}")
            m.d.sync += later.eq(late)
            late = later
        glitches = Signal.like(self.rejected_glitches)
        m.d.sync += glitches.eq(glitches + late)
        with m.If(self.publish):
            m.d.sync += self.rejected_glitches.eq(glitches)
