"""Distance: pulses of successive snapshots add up, whatever the alignment of edge and read."""

from __future__ import annotations

from amaranth.hdl import Module, Mux, Signal, Value

from railgate.odometer.proofs.contract import LATE, Observed, counts
from railgate.odometer.spec import Config, Flag
from railgate.proving import Claim, Induction, Internals, Mutant, Run, Search

__all__ = ["CLAIMS"]

READ = Search(24)
"""Ticks from reset within which an edge can be counted, read, and told."""

MANY_READS = Run(5_000)
"""Random edges and strobes."""


class _Pulses(Observed):
    """Σ of `pulses` over all snapshots is the number of the pin's rising edges up to the strobe.

    Of a snapshot whose pulses stay at their greatest value, flagged SATURATED, nothing is claimed;
    the sum starts anew after it.
    """

    def __init__(self) -> None:
        super().__init__(Config(), lemmas=("counts", "carried", "pending"))

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.odometer(m)
        strobes = self.strobes

        width = self.config.count_bits
        edges_a, edges_b, pulses = (Signal(width, name=f"edges_{of}") for of in ("a", "b", "new"))
        rise = self.on_a.rise
        edges_a_now, edges_b_now = edges_a + rise, edges_b + self.on_b.rise
        full, full_now = Signal(), Signal()  # one more was not counted
        pulses_now = Mux(pulses.all(), pulses, pulses + rise)
        m.d.comb += full_now.eq(full | (pulses.all() & rise))
        m.d.sync += [
            edges_a.eq(edges_a_now),
            edges_b.eq(edges_b_now),
            pulses.eq(Mux(strobes.opens, 0, pulses_now)),
            full.eq(full_now & ~strobes.opens),
        ]
        counted, carried = self.reports(
            m,
            inner,
            {
                "a_rising": (edges_a, edges_a_now),
                "b_rising": (edges_b, edges_b_now),
                "pulses": (self.cleared("pulses", pulses), pulses_now),
            },
        )

        at_strobe, told, full_at_strobe = Signal(width), Signal(width), Signal()
        out = inner["sensor.0.pulses"]
        with m.If(strobes.opens):
            m.d.sync += [at_strobe.eq(edges_a_now), full_at_strobe.eq(full_now)]
        with m.If(strobes.delivers):
            m.d.sync += told.eq(Mux(self._full(out, inner), at_strobe, told + out))

        account = ((told + out)[:width] == at_strobe) | self._full(out, inner)
        saturated, flagged = self.flagged(m, inner, Flag.SATURATED, full, full_at_strobe)
        copy = self.at_strobe["pulses"]
        on_the_way = ((told + copy)[:width] == at_strobe) | full_at_strobe
        m.d.comb += [
            self.lemma.counts.eq(
                counts(inner, "sensor_0.a_rising")
                & counts(inner, "sensor_0.b_rising")
                & counts(inner, "sensor_0.pulses", saturates=True)
            ),
            self.lemma.carried.eq(carried & flagged),
            self.lemma.pending.eq(
                Mux(strobes.opened[LATE:].any(), on_the_way, told == at_strobe)
                & (full | ((at_strobe + pulses)[:width] == edges_a))
                & (~full | pulses.all())
                & (~full_at_strobe | copy.all())
            ),
            self.holds.eq(counted & saturated & (~strobes.delivers | account)),
            self.reached.eq(strobes.delivers & (out == 1) & (edges_a != at_strobe)),
        ]
        return m

    def _full(self, pulses: Value, inner: Internals) -> Value:
        return pulses.all() & (inner["sensor.0.flags"] & Flag.SATURATED).any()


def _mutant(
    name: str, old: str, new: str, rejected: Run | Search = READ, file: str = "sensor"
) -> Mutant:
    return Mutant(name, f"railgate.odometer.gateware.{file}", old, new, rejected)


CLAIMS = (
    Claim(
        name="odometer.pulses",
        claim=(
            "Whatever the alignment of edges and strobes, also of strobes while busy, the pulses "
            "of all snapshots add up to the pin's rising edges of A up to the strobe's tick, none "
            "lost and none twice, unless pulses is full and flagged SATURATED; a_rising and "
            "b_rising tell the edges of each pin (sensor 0; default configuration, modulo 2³²)."
        ),
        requirements=("ODO-6", "ODO-7"),
        monitor=_Pulses,
        method=Induction(12),
        cover=READ,
        mutants=(
            _mutant("strobe-wins-over-edge", " | (a_rise & latch))", ")", MANY_READS),
            _mutant(
                "read-does-not-clear",
                "self.pulses, counted, restart=latch",
                "self.pulses, counted, restart=0",
                MANY_READS,
            ),
            _mutant("both-edges", "counted.eq((a_soon &", "counted.eq((a_edge &"),
            _mutant("other-channel", "self.a_rising, a_rise", "self.a_rising, b_rise"),
            _mutant(
                "reads-while-busy", "self.strobe & ~self.busy", "self.strobe", READ, "odometer"
            ),
        ),
        fast=False,
    ),
)
