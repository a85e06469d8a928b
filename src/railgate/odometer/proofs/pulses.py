"""Distance: pulses of successive snapshots add up, whatever the alignment of edge and read."""

from __future__ import annotations

from amaranth.hdl import Module, Mux, Signal, Value

from railgate.odometer.proofs.contract import Observed
from railgate.odometer.spec import Config, Flag
from railgate.proving import Claim, Induction, Mutant, Run, Search

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

        edges_a, edges_b = Signal(self.config.count_bits), Signal(self.config.count_bits)
        edges_a_now, edges_b_now = edges_a + self.on_a.rise, edges_b + self.on_b.rise
        m.d.sync += [edges_a.eq(edges_a_now), edges_b.eq(edges_b_now)]
        counted, carried = self.reports(
            m, inner, {"a_rising": edges_a_now, "b_rising": edges_b_now}
        )

        at_strobe, told = Signal.like(edges_a), Signal.like(edges_a)
        pulses = inner["sensor.0.pulses"]
        with m.If(strobes.opens):
            m.d.sync += at_strobe.eq(edges_a_now)
        with m.If(strobes.delivers):
            full = self._full(pulses, inner["sensor.0.flags"])
            m.d.sync += told.eq(Mux(full, at_strobe, told + pulses))

        def account(before: Value, where: str, after: Value) -> Value:
            pulses, flags = inner[where.format("pulses")], inner[where.format("flags")]
            return ((before + pulses)[: len(before)] == after) | self._full(pulses, flags)

        delivered = account(told, "sensor.0.{}", at_strobe)
        on_the_way = Mux(strobes.busy, account(told, "latched_0_{}", at_strobe), told == at_strobe)
        m.d.comb += [
            self.lemma.counts.eq(
                (inner["sensor_0.a_rising"] == edges_a) & (inner["sensor_0.b_rising"] == edges_b)
            ),
            self.lemma.carried.eq(carried),
            self.lemma.pending.eq(
                Mux(
                    strobes.latches,
                    account(told, "sensor_0.{}", edges_a) & (at_strobe == edges_a),
                    account(at_strobe, "sensor_0.{}", edges_a) & (strobes.delivers | on_the_way),
                )
            ),
            self.holds.eq(counted & (~strobes.delivers | delivered)),
            self.reached.eq(strobes.delivers & (pulses == 1) & (edges_a != at_strobe)),
        ]
        return m

    def _full(self, pulses: Value, flags: Value) -> Value:
        return (pulses == (1 << self.config.count_bits) - 1) & (flags & Flag.SATURATED).any()


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
        method=Induction(),
        cover=READ,
        mutants=(
            _mutant(
                "strobe-wins-over-edge",
                "self.pulses.eq(pulses + (a.rise & ~pulses_full))",
                "self.pulses.eq(Mux(self.latch, 0, pulses + (a.rise & ~pulses_full)))",
                MANY_READS,
            ),
            _mutant(
                "read-does-not-clear", "Mux(self.latch, 0, self.pulses)", "self.pulses", MANY_READS
            ),
            _mutant("both-edges", "pulses + (a.rise &", "pulses + (a_edge &"),
            _mutant("other-channel", "self.a_rising + a.rise", "self.a_rising + b.rise"),
            _mutant(
                "reads-while-busy", "self.strobe & ~self.busy", "self.strobe", READ, "odometer"
            ),
        ),
    ),
)
