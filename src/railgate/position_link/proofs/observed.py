"""A link with the contract beside it: the shape of the monitors of reading and supervision."""

from __future__ import annotations

from collections.abc import Iterable

from amaranth.hdl import Cat, Module, Mux, Value

from railgate.position_link.proofs.reading import Reading
from railgate.position_link.proofs.schedule import Cycle
from railgate.position_link.spec import Cause, Config, Edge
from railgate.proving import Internals, Monitor

__all__ = ["Observed", "schedule"]

READING = ("divider", "schedule", "pins", "reader", "ends", "verdict")


def schedule(inner: Internals, config: Config, cycle: Cycle) -> Value:
    """The invariant that binds the gateware's schedule to the ticks of the late cycle."""
    latency = config.delivery_latency_ticks
    decision = config.decision_ticks - config.input_delay_ticks
    opens, closes = config.rise(config.earliest_clk - 1), config.rise(config.window_bits)
    falls = cycle.edges[0] ^ (config.sampling_edge is Edge.RISING)
    remaining = inner["timing.until_delivery.remaining"]
    left = [cycle.at(decision + n) & (remaining == latency - n) for n in range(latency)]
    waits = cycle.before(decision) | ~cycle.before(decision + latency)
    return Cat(
        inner["timing.starts"] == cycle.at(0),
        inner["timing.early"] == cycle.before(opens),
        inner["timing.open"] == (~cycle.before(opens) & cycle.before(closes)),
        inner["timing.closes"] == cycle.at(closes),
        inner["timing.sample"] == (cycle.edge & falls),
        Mux(waits, remaining == 0, Cat(*left).any()),
        inner["timing.delivery"] == cycle.at(decision + latency),
    ).all()


class Observed(Monitor):
    """A link whose pins are free, and what the contract finds on them; `lemmas` are further ones.

    `self.reading` is the contract's; its invariants are for any configuration.
    """

    def __init__(self, config: Config, lemmas: Iterable[str] = ()) -> None:
        super().__init__({"uef": 1, "data": 1}, (*READING, *lemmas))
        self.config = config
        self.reading = Reading(config)

    def link(self, m: Module) -> Internals:
        """Adds both, and binds them to one another."""
        from railgate.position_link.gateware import PositionLink

        m.submodules.dut = inner = Internals(dut := PositionLink(self.config))
        m.submodules.reading = reading = self.reading
        m.d.comb += [
            dut.uef.eq(self.uef),
            dut.data.eq(self.data),
            reading.uef.eq(self.uef),
            reading.data.eq(self.data),
            self.lemma.divider.eq(reading.cycle.agrees(inner, "timing.delayed")),
            self.lemma.schedule.eq(schedule(inner, self.config, reading.cycle)),
            self.lemma.pins.eq(
                reading.on_uef.agrees(inner, "input_uef")
                & reading.on_data.agrees(inner, "input_data")
            ),
            self.lemma.reader.eq(self._reader(inner)),
            self.lemma.ends.eq(self._ends()),
            self.lemma.verdict.eq(self._verdict(inner)),
        ]
        return inner

    def _reader(self, inner: Internals) -> Value:
        """The gateware's reader has found what the contract has."""
        reading, config = self.reading, self.config
        answer, causes = Value.cast(inner["reader.answer"]), inner["reader.causes"]
        none, under_way, complete = range(3)
        decided = reading.after_decision(1)
        agrees = [
            inner["reader.seen"] == reading.seen,
            (answer == none) == ~reading.answered,
            (answer == under_way) == reading.under_way,
            (answer == complete) == reading.complete,
            inner["reader.bits"] == reading.bits,
            inner["reader.word"] == reading.word,
            causes == Mux(decided, reading.found, reading.causes)[: len(causes)],
            reading.causes[len(causes) :] == 0,
            ~decided | (reading.causes == 0),
        ]
        if config.check:
            agrees.append(inner["reader.check.register"] == reading.field)
        for timer, past in (("settling", reading.edges), ("holding", reading.taken)):
            if len(past):
                left = 0
                for ago in reversed(range(len(past))):
                    left = Mux(past[ago], len(past) - ago, left)
                agrees.append(inner[f"reader.{timer}.remaining"] == left)
        return Cat(*agrees).all()

    def _ends(self) -> Value:
        """An answer under way has begun in the window, and with `word_bits` bits it ends with the
        next sample: before the decision."""
        reading, config = self.reading, self.config
        rising = config.sampling_edge is Edge.RISING
        samples = (reading.cycle.edges + rising) >> 1
        begun = ~reading.cycle.before(config.rise(config.earliest_clk - 1) + 1) & reading.answered
        ends = samples <= config.window_bits + reading.bits
        return (
            (~reading.under_way | (begun & ends & reading.cycle.before(reading.decision)))
            & (reading.bits <= config.word_bits)
            & ~(reading.under_way & reading.complete)
            & (reading.answered | ~reading.complete)
        )

    def _verdict(self, inner: Internals) -> Value:
        """In how many ticks after the decision the gateware's verdict has found what."""
        reading, config = self.reading, self.config
        latency = config.delivery_latency_ticks

        def from_tick(first: int, holds: Value) -> Value:
            since = (reading.after_decision(n) for n in range(first, latency))
            return ~Cat(*since).any() | holds

        wrong = {Cause.FAULT_WORD: reading.read == config.invalid_word}
        compared = [inner["verdict.fault_word_differs"].any() != wrong[Cause.FAULT_WORD]]
        if config.zero_is_fault:
            wrong[Cause.ZERO_WORD] = reading.read == 0
            compared.append(inner["verdict.nonzero"].any() != wrong[Cause.ZERO_WORD])
        if check := config.check:
            wrong[Cause.CHECK] = reading.read[: check.width] != reading.field ^ check.final
            compared.append(inner["verdict.check_differs"].any() == wrong[Cause.CHECK])
        of_word = []
        for cause in (Cause.CHECK, Cause.FAULT_WORD, Cause.ZERO_WORD):
            told = (reading.found & cause).any() == (reading.was_complete & wrong.get(cause, 0))
            # The register of the check is the next answer's from the next window on.
            of_word.append(from_tick(1, told) if config.check and cause is Cause.CHECK else told)
        line = inner["verdict.line"]
        stands = (reading.complete == reading.was_complete) & (reading.word == reading.read)
        return Cat(
            from_tick(1, stands),
            from_tick(2, Cat(*compared).all() & (line == reading.found[: len(line)])),
            from_tick(3, inner["verdict.causes"] == reading.found),
            from_tick(4, inner["verdict.good"] == reading.good),
            reading.good == (reading.was_complete & (reading.found == 0)),
            *of_word,
        ).all()
