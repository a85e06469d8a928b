"""What the contract makes of the cycles that it has found good or faulty."""

from __future__ import annotations

from collections.abc import Iterable

from amaranth.hdl import Cat, Module, Mux, Signal, Value

from railgate.position_link.proofs.observed import Observed
from railgate.position_link.spec import Config, Status
from railgate.proving import Internals

__all__ = ["Supervised"]

TURNS = 5
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
        """The gateware knows before the delivery whether the link goes up or down with it."""
        config = self.config
        since = [
            self.reading.after_decision(n) for n in range(TURNS, config.delivery_latency_ticks)
        ]
        last = Mux(self.down, config.recovery_cycles, config.tolerated_cycles) - 1
        turns = (self.reading.good == self.down) & (inner["supervision.run"] == last)
        return ~Cat(*since).any() | (inner["supervision.turns"] == turns)

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
