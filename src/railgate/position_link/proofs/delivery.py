"""Delivery: one a cycle, at its fixed phase, for ever."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Signal, Value

from railgate.position_link.proofs.clock import TWO_CYCLES, Timed
from railgate.position_link.proofs.observed import numbered, schedule
from railgate.position_link.proofs.schedule import Cycle
from railgate.position_link.proofs.stimuli import mutant
from railgate.position_link.spec import cause_names
from railgate.proving import Claim, Induction, Internals, Run

__all__ = ["CLAIMS"]

FIRST_DELIVERY = Run(8_000)
"""Ticks from reset within which the first cycle is delivered."""


class _Delivery(Timed):
    """One tick of `delivery` a cycle, at its phase, and no field that changes in another."""

    def __init__(self) -> None:
        super().__init__(("late", "schedule", "counted"))

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner, now = self.link(m)
        config = self.config
        m.submodules.late = late = Cycle(config, config.input_delay_ticks)
        delivery, deliveries = inner["delivery"], Signal(config.count_bits)
        deliveries_now = (deliveries + delivery)[: config.count_bits]
        stay, started = [], Signal()
        for field in config.fields:
            value = inner[field.name]
            past = Signal(field.width, name=f"past_{field.name}", init=field.start)
            m.d.sync += past.eq(value)
            stay.append(value == past)
        m.d.sync += [deliveries.eq(deliveries_now), started.eq(1)]
        m.d.comb += [
            self.lemma.late.eq(
                late.agrees(inner, "timing.delayed") & late.follows(now, config.input_delay_ticks)
            ),
            self.lemma.schedule.eq(schedule(inner, config, late)),
            self.lemma.counted.eq(
                (inner["number"] == deliveries_now)
                & numbered(inner, config, late)
                & self._chosen(inner, late)
            ),
            self.holds.eq(
                (delivery == now.at(config.delivery_ticks))
                & (delivery | Cat(*stay).all())
                & (inner["number"] == deliveries_now)
            ),
            self.reached.eq(delivery & (deliveries == 1)),
        ]
        return m

    def _chosen(self, inner: Internals, late: Cycle) -> Value:
        """What changes fields, in the tick before a delivery alone."""
        counts = ("faulty_cycles", *(f"{name}_cycles" for name in cause_names()))
        steps = [inner[f"supervision.count_{name}.step"] for name in counts]
        decision = self.config.decision_ticks - self.config.input_delay_ticks
        publishes = late.at(decision + self.config.delivery_latency_ticks - 1)
        anything = Cat(inner["supervision.renews"], *steps).any()
        return ~anything | publishes


CLAIMS = (
    Claim(
        name="position_link.delivery",
        claim=(
            "For ever, each cycle has exactly one tick with delivery = 1, 7 443 ticks after the "
            "one in which ANF rises, from the first cycle on and whatever UEF and DATA; in it the "
            "number grows by 1, and in no other tick does any field change (default configuration)."
        ),
        requirements=("LNK-6",),
        monitor=_Delivery,
        method=Induction(),
        cover=TWO_CYCLES,
        mutants=(
            mutant(
                "a-tick-early",
                "timing",
                "self.publish.eq(since_decision[-2])",
                "self.publish.eq(since_decision[-3])",
                FIRST_DELIVERY,
            ),
            mutant(
                "a-clk-early",
                "timing",
                "config.window_bits + config.word_bits + 1",
                "config.window_bits + config.word_bits",
                FIRST_DELIVERY,
            ),
            mutant(
                "only-good-ones",
                "supervision",
                '"number": Const(1)',
                '"number": self.good',
                FIRST_DELIVERY,
            ),
            mutant(
                "field-follows-live",
                "supervision",
                "m.d.sync += first_turn.eq(",
                "m.d.sync += self.causes.eq(self.found)\n        m.d.sync += first_turn.eq(",
                FIRST_DELIVERY,
            ),
        ),
        fast=False,
    ),
)
