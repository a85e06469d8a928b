"""What a verdict makes of the link: its state and counts, and the fields of the delivery."""

from __future__ import annotations

from amaranth.hdl import Cat, Const, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.position_link.spec import Cause, Config, Health, Status, cause_names
from railgate.primitives import ChunkedSum, LookaheadCounter

__all__ = ["Supervision"]

LOW_BITS = 7
"""Bits of the count of glitches that may change in every tick, fewer than any count has."""


class Supervision(wiring.Component):
    """Brings the link up and down, counts, and holds the fields between two deliveries.

    settled, publish: in, 1 bit, see Timing. good, found: in, see Verdict (there `causes`); a tick
    before `settled` they stand. read, since_rise: in, see Reader (there `word`). uef_glitch,
    data_glitch: in, 1 bit each, rejected in this tick.
    One out of each of config.fields, registers. Requirements LNK-5, LNK-6, LNK-7.

    The fields themselves are the state: the link is down where status is FAULT, and up in HELD the
    word is that of the last good cycle. What may become of them is made ready from one delivery to
    the next, which only chooses.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        inputs = ("settled", "publish", "good", "uef_glitch", "data_glitch")
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
        self._state(m)
        self._age(m)
        self._age_ticks(m)
        self._counts(m)
        self._glitches(m)
        return m

    def _state(self, m: Module) -> None:
        """Status, word, health and causes."""
        config = self._config
        tolerated, recovery = config.tolerated_cycles, config.recovery_cycles

        up = self.status != Status.FAULT
        run = Signal(range(max(tolerated, recovery)))
        last = Signal(init=recovery == 1)  # with one more, the run is long enough
        against = up ^ self.good  # faulty while up, good while down: `run` of them before
        turns = against & last
        longer = Signal()
        up_next = Signal()
        m.d.sync += [
            last.eq(run == Mux(up, tolerated - 1, recovery - 1)),
            longer.eq(against & ~turns),
            up_next.eq(up ^ turns),
        ]
        with m.If(self.publish):
            m.d.sync += run.eq(Mux(longer, run + 1, 0))

        # In START all deliveries so far were of faulty cycles, fewer than tolerated.
        first_turn = Signal(init=tolerated == 1)
        m.d.sync += first_turn.eq(self.number[: tolerated.bit_length()] == tolerated - 1)

        starts = (self.health == Health.START) & ~first_turn
        if_up, if_down = Signal(Health, name="if_up"), Signal(Health, name="if_down")
        # Of the next delivery; FAULT is 0.
        status, health = Signal(Status, name="next_status"), Signal(Health, name="next_health")
        renews = Signal()
        m.d.sync += [
            status.eq(Mux(self.good, Status.FRESH, Status.HELD) & up_next.replicate(2)),
            if_up.eq(Mux(self.good, Health.OK, Health.WARNING)),
            if_down.eq(Mux(self.good, Health.RECOVERING, Mux(starts, Health.START, Health.ALARM))),
            health.eq(Mux(up_next, if_up, if_down)),
            renews.eq(self.settled & (self.good | ~up_next)),
        ]
        with m.If(self.publish):
            m.d.sync += [
                self.status.eq(status),
                self.health.eq(health),
                self.causes.eq(self.found),
            ]
        with m.If(renews):
            m.d.sync += self.word.eq(Mux(status == Status.FAULT, config.invalid_word, self.read))

    def _age(self, m: Module) -> None:
        """The age in cycles."""
        never = (1 << len(self.age)) - 1
        grows = Signal()  # the age was not its greatest value a tick ago
        older = Signal.like(self.age, init=never)
        m.d.sync += [grows.eq(self.age != never), older.eq(self.age + grows)]
        with m.If(self.publish):
            m.d.sync += self.age.eq(Mux(self.good, 0, older))

    def _age_ticks(self, m: Module) -> None:
        """The age in ticks; from one delivery to the next these are cycle_ticks."""
        width = len(self.age_ticks)
        old = (1 << width) - 1
        m.submodules.ticks_older = older = ChunkedSum(width, self._config.cycle_ticks, start=old)
        following = Signal(width)
        since_rise = Mux(self.since_rise > old, old, self.since_rise)
        m.d.comb += older.value.eq(self.age_ticks)
        too_old = (older.overflow & ~self.good).replicate(width)
        m.d.sync += following.eq(Mux(self.good, since_rise, older.total) | too_old)
        with m.If(self.publish):
            m.d.sync += self.age_ticks.eq(following)

    def _counts(self, m: Module) -> None:
        """The deliveries, the faulty ones, and those with each cause."""
        counted = {
            f"{name}_cycles": found for name, found in zip(cause_names(), self.found, strict=True)
        }
        counted |= {"number": Const(1), "faulty_cycles": ~self.good}
        for name, found in counted.items():
            m.submodules[f"count_{name}"] = count = LookaheadCounter(1 << len(getattr(self, name)))
            m.d.sync += count.step.eq(self.settled & found)
            m.d.comb += getattr(self, name).eq(count.value)

    def _glitches(self, m: Module) -> None:
        """Counts each so late that, when the fields change, those up to the decision are in."""
        late = Cat(self.uef_glitch, self.data_glitch)
        for stage in range(self._config.delivery_latency_ticks - 4):
            later = Signal(2, name=f"glitches_{stage}")
            m.d.sync += later.eq(late)
            late = later
        sum_late = Signal(2)
        low = Signal(LOW_BITS)
        low_late = Signal(LOW_BITS)
        carry = Signal()
        m.d.sync += [
            sum_late.eq(late[0] + late[1]),
            Cat(low, carry).eq(low + sum_late),
            low_late.eq(low),
        ]
        m.submodules.high = high = LookaheadCounter(1 << len(self.rejected_glitches) - LOW_BITS)
        m.d.comb += high.step.eq(carry)
        with m.If(self.publish):
            m.d.sync += self.rejected_glitches.eq(Cat(low_late, high.value))
