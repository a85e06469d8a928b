"""What the contract makes of the cycles that it has found good or faulty."""

from __future__ import annotations

from collections.abc import Iterable

from amaranth.hdl import Cat, Module, Mux, Signal, Value

from railgate.position_link.proofs.observed import Observed, numbered
from railgate.position_link.spec import Config, Health, Status
from railgate.proving import Internals

__all__ = ["Supervised"]

TURNS = 6
"""So many ticks after the decision the gateware knows at the latest whether the link turns."""
RUN_BITS = 8
"""A run of cycles is told up to 255, the greatest of tolerated_cycles and recovery_cycles."""


class Supervised(Observed):
    """Beside what was read, the runs of good and faulty cycles, as of the last delivery.

    faulty_run, good_run: in a row up to this delivery, at most 255. ever_good: there was a good
    one since reset. down: the link is. found, good, read: of the delivered cycle, see Reading.
    last: the word of the last good cycle.
    """

    def __init__(self, config: Config, lemmas: Iterable[str] = ()) -> None:
        super().__init__(config, ("turns", "runs", "told", *lemmas))
        self.faulty_run, self.good_run = (
            Signal(RUN_BITS, name=name) for name in ("faulty_run", "good_run")
        )
        self.down, self.ever_good, self.good = Signal(init=1), Signal(), Signal()
        self.found = Signal.like(self.reading.found)
        self.read, self.last = Signal(config.word_bits), Signal(config.word_bits)

    def link(self, m: Module) -> Internals:
        inner, reading = super().link(m), self.reading
        with m.If(reading.after_decision(self.config.delivery_latency_ticks - 1)):
            good = reading.good
            faulty_run = Mux(good, 0, self.faulty_run + ~self.faulty_run.all())
            good_run = Mux(good, self.good_run + ~self.good_run.all(), 0)
            m.d.sync += [
                self.faulty_run.eq(faulty_run),
                self.good_run.eq(good_run),
                self.good.eq(good),
                self.found.eq(reading.found),
                self.read.eq(reading.read),
            ]
            with m.If(good):
                m.d.sync += [self.ever_good.eq(1), self.last.eq(reading.read)]
            with m.If(good_run >= self.config.recovery_cycles):
                m.d.sync += self.down.eq(0)
            with m.If(faulty_run >= self.config.tolerated_cycles):
                m.d.sync += self.down.eq(1)
        m.d.comb += [
            self.lemma.turns.eq(self._turns(inner)),
            self.lemma.runs.eq(self._runs(inner)),
            self.lemma.told.eq(self._told(inner)),
        ]
        return inner

    def _turns(self, inner: Internals) -> Value:
        """What the gateware has made ready of the next delivery, and when."""
        config, reading, good = self.config, self.reading, self.reading.good
        latency = config.delivery_latency_ticks

        def from_tick(first: int, *holds: Value) -> Value:
            since = (reading.after_decision(n) for n in range(first, latency))
            return ~Cat(*since).any() | Cat(*holds).all()

        run, up, told = inner["supervision.run"], ~self.down, inner["delivery"]
        last = run == Mux(self.down, config.recovery_cycles, config.tolerated_cycles) - 1
        against = up ^ good
        up_next = up ^ (against & last)
        bits = config.tolerated_cycles.bit_length()
        first_turn = inner["number"][:bits] == config.tolerated_cycles - 1
        starts = (inner["health"] == Health.START) & ~first_turn
        if_up = Mux(good, Health.OK, Health.WARNING)
        if_down = Mux(good, Health.RECOVERING, Mux(starts, Health.START, Health.ALARM))
        status = Mux(up_next, Mux(good, Status.FRESH, Status.HELD), Status.FAULT)
        never = (1 << config.age_bits) - 1
        age, settling = inner["age"], told | reading.after_decision(latency + 1)
        return Cat(
            numbered(inner, config, reading.cycle),
            told | (inner["supervision.last"] == last),
            told | (inner["supervision.first_turn"] == first_turn),
            told | (inner["supervision.grows"] == (age != never)),
            settling | (inner["supervision.older"] == Mux(age == never, never, age + 1)),
            from_tick(
                TURNS,
                inner["supervision.up_next"] == up_next,
                inner["supervision.longer"] == (against & ~last),
                inner["supervision.if_up"] == if_up,
                inner["supervision.if_down"] == if_down,
            ),
            from_tick(
                TURNS + 1,
                inner["supervision.next_status"] == status,
                inner["supervision.next_health"] == Mux(up_next, if_up, if_down),
            ),
            inner["supervision.renews"] == (reading.after_decision(TURNS + 1) & (good | ~up_next)),
        ).all()

    def _runs(self, inner: Internals) -> Value:
        config, run = self.config, inner["supervision.run"]
        return Mux(
            self.down,
            (run == self.good_run) & (run < config.recovery_cycles),
            (run == self.faulty_run) & (run < config.tolerated_cycles) & self.ever_good,
        ) & ((self.good_run == 0) | (self.faulty_run == 0))

    def _told(self, inner: Internals) -> Value:
        """All fields but the counts are those of the contract."""
        config, status = self.config, inner["status"]
        up = Mux(self.good, Status.FRESH, Status.HELD)
        never = (1 << config.age_bits) - 1
        age = Mux(self.faulty_run > never, never, self.faulty_run)
        return Cat(
            status == Mux(self.down, Status.FAULT, up),
            inner["word"] == Mux(self.down, config.invalid_word, self.last),
            inner["causes"] == self.found,
            inner["age"] == Mux(self.ever_good, age, never),
            ~self.good | (self.ever_good & (self.good_run != 0) & (self.last == self.read)),
            self.good | (self.good_run == 0),
            ~self.ever_good | (self.last != config.invalid_word),
            ~self.reading.good | (self.reading.read != config.invalid_word),
        ).all()
