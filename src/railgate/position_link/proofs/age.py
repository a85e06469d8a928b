"""Age of the data in ticks."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal, Value

from railgate.position_link.proofs.schedule import CHUNK_BITS
from railgate.position_link.proofs.stimuli import GOOD, NOTHING, Answer, mutant, run
from railgate.position_link.proofs.supervised import Supervised
from railgate.position_link.spec import Config
from railgate.proving import Claim, Induction, Internals

__all__ = ["CLAIMS"]

DEFAULT = Config()


class _Age(Supervised):
    """age_ticks, counted tick by tick from the rise of UEF's pin on."""

    def __init__(self) -> None:
        super().__init__(DEFAULT, ("since", "phase", "age", "limit", "ready"))

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner, reading = self.link(m), self.reading
        config, cycle = self.config, reading.cycle
        told, old = inner["age_ticks"], (1 << config.age_ticks_bits) - 1
        latency = config.delivery_latency_ticks
        delivered = reading.decision + latency

        age = Signal(config.age_ticks_bits, init=old)
        start = config.cycle_ticks - 1 - config.input_delay_ticks - delivered
        phase = Signal(range(config.cycle_ticks), init=start)  # ticks since the last delivery
        m.d.sync += [age.eq(age + ~age.all()), phase.eq(phase + 1)]
        with m.If(reading.after_decision(latency - 1)):
            m.d.sync += phase.eq(0)
            with m.If(reading.good):
                m.d.sync += age.eq(reading.since + 1)

        since = inner["reader.since_rise"]
        now = told + phase
        # cycle.tick + wraps = phase + delivered, of which only the right side is cheap to solve.
        wraps = Mux(cycle.before(delivered), config.cycle_ticks, 0)
        older = told + config.cycle_ticks
        since_rise = reading.since + 1
        due = Mux(reading.good, since_rise, Mux(older > old, old, older))
        m.d.comb += [
            self.lemma.since.eq(
                ~reading.answered
                | cycle.at(0)
                | Mux(
                    inner["reader.begun"],
                    reading.since == config.input_delay_ticks + 1,
                    since == (reading.since + 2)[: len(since)],
                )
                & (reading.since + wraps <= config.input_delay_ticks + phase + delivered)
            ),
            self.lemma.phase.eq(cycle.tick + wraps == phase + delivered),
            self.lemma.age.eq(age == Mux(now > old, old, now)),
            self.lemma.limit.eq(
                ~Cat(*(reading.after_decision(n) for n in range(1, latency))).any()
                | (~reading.good | reading.answered)
            ),
            self.lemma.ready.eq(
                self._older(inner, phase)
                & (~reading.after_decision(latency - 1) | (inner["supervision.following"] == due))
            ),
            self.holds.eq(~inner["delivery"] | (told == age)),
            self.reached.eq(inner["delivery"] & ~self.good & ~age.all()),
        ]
        return m

    def _older(self, inner: Internals, phase: Value) -> Value:
        """The sum of age_ticks and a cycle, a chunk of which is right in each tick."""
        path, told = "supervision.ticks_older", inner["age_ticks"]
        right = []
        for n, at in enumerate(range(0, len(told), CHUNK_BITS)):
            low = at + CHUNK_BITS
            total = (told[:low] + self.config.cycle_ticks % (1 << low))[at : low + 1]
            found = Cat(inner[f"{path}.total"][at:low], inner[f"{path}.carries"][n])
            right.append((phase <= n) | (found == total))
        return Cat(*right).all()


CLAIMS = (
    Claim(
        name="position_link.age-ticks",
        claim=(
            "For ever, in the tick of a delivery age_ticks is the number of ticks since UEF's pin "
            "rose for the last good cycle's answer, its greatest value where that is more or "
            "there was none (default configuration)."
        ),
        requirements=("LNK-7",),
        monitor=_Age,
        method=Induction(),
        cover=run(DEFAULT, [GOOD], NOTHING),
        mutants=(
            mutant(
                "a-tick-less",
                "reader",
                "config.input_delay_ticks + 4",
                "config.input_delay_ticks + 3",
                run(DEFAULT, [GOOD]),
            ),
            mutant(
                "from-any-rise",
                "reader",
                "Mux(begun, at_rise",
                "Mux(_later(m, self.uef_rise, 'rises'), at_rise",
                run(DEFAULT, [GOOD], [GOOD, Answer(0, clk=96, bits=2, late_ticks=2)]),
            ),
            mutant(
                "stays-in-faulty-cycles",
                "supervision",
                "Mux(self.good, since_rise, older.total) | too_old",
                "Mux(self.good, since_rise, self.age_ticks)",
                run(DEFAULT, [GOOD], NOTHING),
            ),
        ),
        fast=False,
    ),
)
