"""Periods: successive ones add up to the ticks elapsed."""

from __future__ import annotations

from amaranth.hdl import Module, Mux, Signal

from railgate.odometer.proofs.contract import Observed, aged
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
        begun, total = Signal(), Signal(TICK_BITS)
        saturated, closes, closed = Signal(), Signal(), Signal()
        rise, counts = self.on_a.rise, self.on_a.age(0)
        m.d.sync += [closes.eq(rise & begun), closed.eq(closes)]
        with m.If(counts):
            m.d.sync += [tick.eq(tick + 1), since.eq(Mux(since.all(), since, since + 1))]
        with m.If(rise):
            m.d.sync += [last.eq(tick), since.eq(1), begun.eq(1), saturated.eq(since >= limit)]
            with m.If(~begun):
                m.d.sync += first.eq(tick)
        period = inner["sensor_0.period"]
        total_now = Mux(saturated, last - first, (total + period)[:TICK_BITS])
        with m.If(closed):
            m.d.sync += total.eq(total_now)

        pending = closes | closed
        m.d.comb += [
            self.lemma.elapsed.eq(
                (since.all() | ((tick - last)[:TICK_BITS] == since))
                & (counts | ((tick == 0) & ~begun))
                & aged(inner, self.on_a, since, limit)
            ),
            self.lemma.begun.eq(
                (inner["sensor_0.period.begun"] == (begun | rise))
                & (begun | (~pending & (total == 0)))
            ),
            self.lemma.sum.eq(pending | (total == (last - first)[:TICK_BITS])),
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
        method=Induction(8),
        mutants=(
            _mutant(
                "restarts-at-two",
                'init=1, reset_less=True, name=f"age',
                'init=2, reset_less=True, name=f"age',
            ),
            _mutant(
                "never-restarts",
                "restart.eq((self.edge_soon & (boundary_soon != which)) | self.tick_0_soon)",
                "restart.eq(self.tick_0_soon)",
            ),
            _mutant(
                "tick-missing",
                "period.elapsed.eq(ages.last)",
                "period.elapsed.eq(ages.since_last)",
                "sensor",
            ),
            _mutant(
                "from-any-edge", "ages.edge_soon.eq(a_soon)", "ages.edge_soon.eq(a_edge)", "sensor"
            ),
            _mutant("other-counter", "Mux(last, *ages[::-1])", "Mux(newest, *ages[::-1])"),
            _mutant("clean-only", "with m.If(closed):", "with m.If(self.judged):", "period"),
        ),
        fast=False,
    ),
)
