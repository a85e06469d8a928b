"""A link with the contract beside it: the shape of the monitors of reading and supervision."""

from __future__ import annotations

from collections.abc import Iterable

from amaranth.hdl import Cat, Const, Module, Mux, Value

from railgate.position_link.proofs.reading import Reading
from railgate.position_link.proofs.schedule import CHUNK_BITS, Cycle
from railgate.position_link.spec import Cause, Config, Edge
from railgate.proving import Internals, Monitor

__all__ = ["Observed", "numbered", "schedule"]

READING = ("divider", "schedule", "pins", "reader", "timers", "later", "ends", "verdict")
STANDS = 10
"""So many ticks before the decision the word has come to stand."""
VERDICT_BITS = 4
"""So many the gateware's verdict makes one."""


def schedule(inner: Internals, config: Config, cycle: Cycle) -> Value:
    """The invariant that binds the gateware's schedule to the ticks of the late cycle."""
    latency = config.delivery_latency_ticks
    decision = config.decision_ticks - config.input_delay_ticks
    opens, closes = config.rise(config.earliest_clk - 1), config.rise(config.window_bits)
    falls = cycle.edges[0] ^ (config.sampling_edge is Edge.RISING)
    since = inner["timing.since_decision"]
    return Cat(
        inner["timing.starts"] == cycle.at(0),
        inner["timing.early"] == cycle.before(opens),
        inner["timing.open"] == (~cycle.before(opens) & cycle.before(closes)),
        inner["timing.closes"] == cycle.at(closes),
        inner["timing.sample"] == (cycle.edge & falls),
        *(since[n] == cycle.at(decision + n) for n in range(latency + 1)),
    ).all()


def numbered(inner: Internals, config: Config, cycle: Cycle) -> Value:
    """The number of the delivery has its step a tick before it, and what it looks ahead is right
    some ticks after it."""
    path, number = "supervision.count_number", inner["number"]
    delivery = config.delivery_ticks - config.input_delay_ticks
    full = Cat(number[at : at + CHUNK_BITS].all() for at in range(0, len(number), CHUNK_BITS))
    carries = Cat(full[:n].all() for n in range(len(full)))
    changed = [cycle.at(delivery + n) for n in range(2)]
    return Cat(
        inner[f"{path}.step"] == cycle.at(delivery - 1),
        changed[0] | (inner[f"{path}.full"] == full),
        changed[0] | changed[1] | (inner[f"{path}.carries"] == carries),
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
            self.lemma.timers.eq(self._timers(inner)),
            self.lemma.later.eq(inner["reader.data_then"] == reading.on_data.before),
            self.lemma.ends.eq(self._ends()),
            self.lemma.verdict.eq(self._verdict(inner)),
        ]
        return inner

    def _reader(self, inner: Internals) -> Value:
        """The gateware's reader has found what the contract has."""
        reading, config = self.reading, self.config
        causes = inner["reader.causes"]
        begun, ends, samples, lacking, whole, last, taken = (
            inner[f"reader.{name}"]
            for name in ("begun", "ends", "samples", "lacking", "whole", "last", "taken")
        )
        # What the gateware has registered but not yet done: it is a tick late, or two.
        filled = samples & lacking & ~ends & last
        goes_on = begun | (lacking & ~ends)
        takes = samples & goes_on
        pending = takes | taken
        bit = Mux(taken, inner["reader.bit"], inner["reader.data_then"])
        bits, word = inner["reader.bits"], inner["reader.word"]
        slow = reading.cycle.stretch_ticks - 2 * reading.cycle.stretch_edges
        opened = ~reading.cycle.before(config.rise(config.earliest_clk - 1) + 1)
        before, full = reading.cycle.ahead, reading.bits == config.word_bits
        agrees = [
            inner["reader.seen"] == reading.seen,
            inner["reader.answered"] == reading.answered,
            (goes_on & ~filled) == (reading.under_way & ~full),
            (filled | (whole & ~ends & ~samples)) == (reading.under_way & full),
            ((whole & ends) | inner["reader.complete"]) == reading.complete,
            ~(lacking & whole) & ~(begun & (lacking | whole)) & ~(begun & ends),
            ~(lacking | whole | begun) | (opened & reading.cycle.before(reading.decision + 1)),
            ~samples | (before > slow),
            ~taken | (before > slow - reading.cycle.stretch_edges),
            ~(samples & taken),
            takes == reading.taken[0],
            taken == reading.taken[1],
            last == (bits == config.word_bits - 1),
            Mux(reading.answered, (bits + pending) == reading.bits, (bits == 0) & ~pending),
            reading.word == Mux(pending, Cat(bit, word), word)[: len(word)],
        ]
        if config.check:
            field, covered = inner["reader.check.register"], inner["reader.covered"]
            adds = field[-1] ^ bit
            step = (field << 1)[: len(field)] ^ Mux(adds, config.check.polynomial, 0)
            agrees += [
                covered == (bits < config.word_bits - config.check.width),
                Mux(
                    reading.answered,
                    reading.field == Mux(pending & covered, step, field),
                    field == config.check.initial,
                ),
            ]
        after = {Cause.SHORT: lacking & ends, Cause.LONG: whole & samples & ~ends}
        coming = [
            after[cause] if cause in after else self._coming(inner, cause, takes)
            for cause in Cause
            if cause < Cause.CHECK
        ]
        happened = inner["reader.happened"] | self._unstable(inner, taken)
        n = [reading.after_decision(ticks) for ticks in range(4)]
        old = [causes, Mux(n[3], 0, happened), Mux(n[2] | n[3], 0, Cat(coming))]
        new = [
            Mux(Cat(n[1:4]).any(), 0, causes),
            Mux(n[1] | n[2], 0, happened),
            Mux(n[1], 0, Cat(coming)),
        ]
        width = len(causes)
        agrees += [
            (new[0] | new[1] | new[2]) == reading.causes[:width],
            ~Cat(n[1:4]).any() | ((old[0] | old[1] | old[2]) == reading.found[:width]),
            reading.causes[width:] == 0,
            ~n[1] | (reading.causes == 0),
        ]
        return Cat(*agrees).all()

    def _coming(self, inner: Internals, cause: Cause, takes: Value) -> Value:
        """What the gateware has found of a tick ago, of a cause that is told as it comes."""
        if cause != Cause.UNSTABLE:
            return inner[f"reader.found_{cause.name}".lower()]
        guard, edges, taken = self.config.guard_ticks, self.reading.edges, self.reading.taken
        if not guard:
            return Const(0, 1)
        moves = inner["reader.moves"]
        found = moves & (takes | taken[1 : guard + 1].any())
        return found | (takes & edges[1:guard].any())

    def _unstable(self, inner: Internals, taken: Value) -> Value:
        """What it finds of two ticks ago, at its place among the causes of the line."""
        guard, found = self.config.guard_ticks, Const(0, 1)
        if guard:
            found = inner["reader.moved"] & (taken | inner["reader.holding.active"])
        if guard > 1:
            found |= taken & inner["reader.settling.active"]
        return found << Cause.UNSTABLE.bit_length() - 1

    def _timers(self, inner: Internals) -> Value:
        """The timers around a sample are as far as it is ago."""
        guard, reading = self.config.guard_ticks, self.reading
        if not guard:
            return Const(1, 1)
        agrees = [
            inner["reader.moves"] == reading.edges[0],
            inner["reader.moved"] == reading.edges[1],
        ]
        for timer, past in (("settling", reading.edges[2:]), ("holding", reading.taken[2:])):
            if len(past):
                left = 0
                for ago in reversed(range(len(past))):
                    left = Mux(past[ago], len(past) - ago, left)
                remaining = inner[f"reader.{timer}.remaining"]
                agrees += [
                    remaining == left,
                    inner[f"reader.{timer}.active"] == (remaining != 0),
                ]
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

        def steady(first: int, holds: Value) -> Value:
            """It holds so many ticks after the word has come to stand."""
            stands = reading.decision - STANDS + first
            ended = ~reading.cycle.before(reading.decision + latency)
            return reading.cycle.before(stands) | ended | holds

        word = inner["reader.word"]
        wrong = {Cause.FAULT_WORD: reading.read == config.invalid_word}
        compared = [*self._compared(inner, "fault_word_differs", word ^ config.invalid_word)]
        if config.zero_is_fault:
            wrong[Cause.ZERO_WORD] = reading.read == 0
            compared += self._compared(inner, "nonzero", word)
        if check := config.check:
            field = inner["reader.check.register"] ^ check.final
            wrong[Cause.CHECK] = reading.read[: check.width] != reading.field ^ check.final
            compared += self._compared(inner, "check_differs", word[: check.width] ^ field)
        of_word = []
        for cause in (Cause.CHECK, Cause.FAULT_WORD, Cause.ZERO_WORD):
            told = (reading.found & cause).any() == (reading.was_complete & wrong.get(cause, 0))
            # The register of the check is the next answer's from the next window on.
            of_word.append(from_tick(1, told) if config.check and cause is Cause.CHECK else told)
        line = inner["verdict.line"]
        found = reading.found
        return Cat(
            *(steady(first, holds) for first, holds in compared),
            steady(0, ~inner["reader.taken"] & ~inner["reader.lacking"] & ~inner["reader.begun"]),
            from_tick(1, (reading.complete == reading.was_complete) & (word == reading.read)),
            from_tick(2, inner["reader.complete"] == reading.was_complete),
            from_tick(3, inner["verdict.causes"][len(line) :] == found[len(line) :]),
            from_tick(4, line == found[: len(line)]),
            from_tick(4, inner["verdict.sound"] == (reading.was_complete & (found >> 7 == 0))),
            from_tick(5, inner["verdict.good"] == reading.good),
            inner["verdict.clear"] == (line == 0),
            reading.good == (reading.was_complete & (reading.found == 0)),
            *of_word,
        ).all()

    def _compared(self, inner: Internals, name: str, bits: Value) -> list[tuple[int, Value]]:
        """Each stage of a comparison, and after how many ticks it is that of `bits`."""
        found: list[tuple[int, Value]] = []
        while len(bits) > 1:
            ats = range(0, len(bits), VERDICT_BITS)
            bits = Cat(bits[at : at + VERDICT_BITS].any() for at in ats)
            told = inner[f"verdict.{name}_{len(found)}"]
            found.append((len(found) + 1, told == bits))
        return found
