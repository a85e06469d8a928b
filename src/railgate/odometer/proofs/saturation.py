"""Saturation: what is full stays full, and says so."""

from __future__ import annotations

from functools import partial

from amaranth.hdl import Module, Mux, Signal, Value

from railgate.odometer.proofs.contract import SMALL, Observed, aged, counts
from railgate.odometer.spec import Config, Flag
from railgate.proving import TICK, Claim, Induction, Mutant, Run, Search
from railgate.waves import Trace, Waveform

__all__ = ["CLAIMS"]

READ = Search(24)
"""Ticks from reset within which an edge can be told."""

FULL = 1_200
"""Ticks within which 8 bits of pulses are full, and read so."""


class _Saturation(Observed):
    """Snapshots tell ticks and pulses as they are, or as great as can be told, and flagged.

    What they are is counted by one bit more, up to twice as far.
    """

    def __init__(self, config: Config) -> None:
        super().__init__(config, lemmas=("rise", "edge", "pulses", "period", "flag", "carried"))

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.odometer(m)
        strobes, rise, edge = self.strobes, self.on_a.rise, self.edge
        out = inner["sensor.0.flags"]
        limit, full = self.config.period_max, (1 << self.config.count_bits) - 1

        since_rise, since_edge = (Signal(self.config.period_bits + 1) for _ in range(2))
        pulses, begun = Signal(self.config.count_bits + 1), Signal()
        pulses_now = Mux(pulses.all(), pulses, pulses + rise)
        for since, event in ((since_rise, rise), (since_edge, edge)):
            with m.If(self.on_a.age(0)):
                m.d.sync += since.eq(Mux(event, 1, Mux(since.all(), since, since + 1)))
        m.d.sync += [pulses.eq(Mux(strobes.opens, 0, pulses_now)), begun.eq(begun | rise)]
        due, due_at_strobe = Signal(), Signal()
        due_now = due | (since_rise == limit) | (pulses_now > full)
        m.d.sync += due.eq(due_now & ~strobes.opens)
        with m.If(strobes.opens):
            m.d.sync += due_at_strobe.eq(due_now)

        def register(name: str, now: Value) -> tuple[Value, Value]:
            before = Signal(self.config.period_bits, name=f"{name}_before")
            m.d.sync += before.eq(now)
            return before, now

        period = Signal(self.config.period_bits)
        period_now = Mux(rise & begun, _at_most(limit, since_rise), period)
        m.d.sync += period.eq(period_now)
        told, carried = self.reports(
            m,
            inner,
            {
                "since_rise": register("rise", Mux(rise, 0, _at_most(limit, since_rise))),
                "since_edge": register("edge", Mux(edge, 0, _at_most(limit, since_edge))),
                "pulses": (
                    self.cleared("pulses", _at_most(full, pulses)),
                    _at_most(full, pulses_now),
                ),
                "period": (period, period_now),
            },
        )
        saturated, flagged = self.flagged(m, inner, Flag.SATURATED, due, due_at_strobe)
        edge_age = counts(inner, "sensor_0.edge_age", saturates=True) & (
            ~self.on_a.age(1) | (inner["sensor_0.edge_age"] == _at_most(limit, since_edge))
        )
        m.d.comb += [
            self.lemma.rise.eq(aged(inner, self.on_a, since_rise, limit)),
            self.lemma.edge.eq(~self.on_a.begun | edge_age),
            self.lemma.pulses.eq(counts(inner, "sensor_0.pulses", saturates=True)),
            self.lemma.period.eq(inner["sensor_0.period.begun"] == (begun | rise)),
            self.lemma.flag.eq(flagged & ((pulses <= full) | due)),
            self.lemma.carried.eq(carried),
            self.holds.eq(told & saturated),
            self.reached.eq(
                strobes.delivers & ((inner["sensor.0.period"] != 0) | (out & Flag.SATURATED).any())
            ),
        ]
        return m


def _at_most(limit: int, count: Value) -> Value:
    return Mux(count > limit, limit, count)


def _mutant(name: str, old: str, new: str, file: str, rejected: Run | Search = READ) -> Mutant:
    return Mutant(name, f"railgate.odometer.gateware.{file}", old, new, rejected)


def _bouncing() -> Trace:
    """More edges of A than 8 bits can count and a read; then a rest, and a read again."""
    ticks = range(0, FULL - 102, 2)  # the last is a fall, which voids the window
    a = Waveform.of(ticks, [i % 2 for i in range(len(ticks))])
    reads = FULL - 97, FULL - 45
    changes = [0, *(tick + more for tick in reads for more in range(2))]
    strobe = Waveform.of(changes, [i % 2 for i in range(len(changes))])
    return Trace({"a": a, "strobe": strobe}, TICK, 0, FULL)


_SHALLOW = (
    _mutant(
        "restarts-at-one",
        "since_last.eq(Mux(self.restarts, 0, self.last))",
        "since_last.eq(Mux(self.restarts, 1, self.last))",
        "steps",
    ),
    _mutant(
        "edges-of-a-only",
        "delayed(m, a_edge | b_edge | start, 1",
        "delayed(m, a_edge | start, 1",
        "sensor",
    ),
    _mutant(
        "never-restarts",
        "restart.eq((self.edge_soon & (boundary_soon != which)) | self.tick_0_soon)",
        "restart.eq(self.tick_0_soon)",
        "steps",
    ),
)

_DEEP = Run(FULL, _bouncing)

_CLAIM = (
    "The ticks since the last rising edge of A and since the last edge of any kind, the period "
    "and the pulses of each snapshot are what they are up to the greatest value of their widths, "
    "and stay there, never wrapping; a snapshot of a time in which ticks since the last rising "
    "edge became as great, or more pulses came, has the flag SATURATED"
)

CLAIMS = (
    Claim(
        name="odometer.saturation",
        claim=f"{_CLAIM} (sensor 0; default configuration).",
        requirements=("ODO-2", "ODO-6", "ODO-11", "ODO-12"),
        monitor=partial(_Saturation, Config()),
        method=Induction(12),
        cover=READ,
        mutants=_SHALLOW,
        fast=False,
    ),
    Claim(
        name="odometer.saturation-scaled",
        claim=(
            f"{_CLAIM} (sensor 0; scaled, so that mutants meet the limits: period_bits = 5, "
            "count_bits = 8)."
        ),
        requirements=("ODO-2", "ODO-6", "ODO-11", "ODO-12"),
        monitor=partial(_Saturation, SMALL),
        method=Induction(12),
        cover=READ,
        mutants=(
            _mutant("wraps", "restart=restart, saturates=True", "restart=restart", "steps", _DEEP),
            _mutant(
                "untold",
                "delayed(m, reaches | (counted & pulses_full)",
                "delayed(m, counted & pulses_full",
                "sensor",
                _DEEP,
            ),
            _mutant(
                "pulses-wrap", "restart=latch, saturates=True", "restart=latch", "sensor", _DEEP
            ),
            _mutant(
                "pulses-untold", "reaches | (counted & pulses_full)", "reaches", "sensor", _DEEP
            ),
        ),
    ),
)
