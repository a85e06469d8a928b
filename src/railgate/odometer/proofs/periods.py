"""Periods: successive ones add up to the ticks elapsed."""

from __future__ import annotations

from amaranth.hdl import Module, Mux, Signal

from railgate.odometer.proofs.contract import Observed
from railgate.odometer.spec import Config
from railgate.proving import Claim, Induction, Mutant

__all__ = ["CLAIMS"]

TICK_BITS = 64
"""Of the monitor's own tick, that no train lives to see wrap."""


class _Periods(Observed):
    """Σ of all periods since the first rising edge of A is the ticks from it to the last one.

    After a period that saturated nothing is claimed of the sum but from its closing edge on.
    """

    def __init__(self) -> None:
        super().__init__(Config(), lemmas=("elapsed", "begun", "sum"))

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.odometer(m)
        limit = self.config.period_max

        tick, first, last = (Signal(TICK_BITS, name=name) for name in ("tick", "first", "last"))
        since = Signal(self.config.period_bits + 1)  # last rise, or tick 0, saturating far above
        begun, closed, total = Signal(), Signal(), Signal(TICK_BITS)
        saturated = Signal()
        m.d.sync += [
            tick.eq(tick + 1),
            since.eq(Mux(since.all(), since, since + 1)),
            closed.eq(self.on_a.rise & begun),
        ]
        with m.If(self.on_a.rise):
            m.d.sync += [last.eq(tick), since.eq(1), begun.eq(1), saturated.eq(since >= limit)]
            with m.If(~begun):
                m.d.sync += first.eq(tick)
        period = inner["sensor_0.period"]
        total_now = Mux(saturated, last - first, (total + period)[:TICK_BITS])
        with m.If(closed):
            m.d.sync += total.eq(total_now)

        register = inner["sensor_0.since_rise.ticks"]
        started = inner["sensor_0.since_rise.started"]
        m.d.comb += [
            self.lemma.elapsed.eq(
                (since.all() | ((tick - last)[:TICK_BITS] == since))
                & (started == (since != 0))
                & (register == Mux(since > limit, limit, Mux(started, since - 1, 0)))
            ),
            self.lemma.begun.eq(
                (inner["sensor_0.period.begun"] == begun) & (begun | (~closed & (total == 0)))
            ),
            self.lemma.sum.eq(closed | (total == (last - first)[:TICK_BITS])),
            self.holds.eq(
                ~closed
                | Mux(
                    saturated,
                    (period == limit) & ~inner["sensor_0.period_valid"],
                    total_now == (last - first)[:TICK_BITS],
                )
            ),
            self.reached.eq(closed & (total != 0)),
        ]
        return m


def _mutant(name: str, old: str, new: str, file: str = "steps") -> Mutant:
    return Mutant(name, f"railgate.odometer.gateware.{file}", old, new)


CLAIMS = (
    Claim(
        name="odometer.periods",
        claim=(
            "The periods taken at the rising edges of A add up to exactly the ticks from the first "
            "such edge to the last one, whatever the edges of A and B and the strobes, unless one "
            "of them saturated, which it tells (sensor 0; default configuration; sum modulo 2⁶⁴)."
        ),
        requirements=("ODO-2",),
        monitor=_Periods,
        method=Induction(),
        mutants=(
            _mutant(
                "restarts-at-one",
                "Mux(self.restart, 0, self.now)",
                "Mux(self.restart, 1, self.now)",
            ),
            _mutant("never-restarts", "Mux(self.restart, 0, self.now)", "self.now"),
            _mutant(
                "tick-missing",
                "period.elapsed.eq(since_rise.now)",
                "period.elapsed.eq(since_rise.ticks)",
                "sensor",
            ),
            _mutant(
                "from-any-edge",
                "since_rise.restart.eq(a.rise)",
                "since_rise.restart.eq(a_edge)",
                "sensor",
            ),
            _mutant("clean-only", "with m.If(closes):", "with m.If(closes & clean):", "period"),
        ),
    ),
)
