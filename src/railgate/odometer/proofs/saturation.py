"""Saturation: what is full stays full, and says so."""

from __future__ import annotations

from functools import partial

from amaranth.hdl import Module, Mux, Signal, Value

from railgate.odometer.proofs.contract import SMALL, Observed
from railgate.odometer.spec import Config, Flag
from railgate.proving import TICK, Claim, Induction, Internals, Mutant, Run, Search
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
        limit, full = self.config.period_max, (1 << self.config.count_bits) - 1

        since_rise, since_edge = (Signal(self.config.period_bits + 1) for _ in range(2))
        pulses, begun = Signal(self.config.count_bits + 1), Signal()
        pulses_now = Mux(pulses.all(), pulses, pulses + rise)
        period = Signal(self.config.period_bits)
        closes = rise & begun
        period_now = Mux(closes, _at_most(limit, since_rise), period)
        m.d.sync += [
            since_rise.eq(Mux(rise, 1, Mux(since_rise.all(), since_rise, since_rise + 1))),
            since_edge.eq(Mux(edge, 1, Mux(since_edge.all(), since_edge, since_edge + 1))),
            pulses.eq(Mux(strobes.opens, 0, pulses_now)),
            begun.eq(begun | rise),
            period.eq(period_now),
        ]
        due, due_at_strobe = Signal(), Signal()
        due_now = due | (since_rise == limit) | (pulses_now > full)
        m.d.sync += due.eq(due_now & ~strobes.opens)
        with m.If(strobes.opens):
            m.d.sync += due_at_strobe.eq(due_now)

        told, carried = self.reports(
            m,
            inner,
            {
                "since_rise": Mux(rise, 0, _at_most(limit, since_rise)),
                "since_edge": Mux(edge, 0, _at_most(limit, since_edge)),
                "pulses": _at_most(full, pulses_now),
                "period": period_now,
            },
        )
        live, out = inner["sensor_0.flags"], inner["sensor.0.flags"]
        latched = inner["latched_0_flags"]
        under_way = Mux(strobes.latches, live, latched)
        flags = Mux(strobes.busy, under_way, out)
        counted = inner["sensor_0.pulses"]
        m.d.comb += [
            self.lemma.rise.eq(_binds(inner, "since_rise", since_rise, limit)),
            self.lemma.edge.eq(_binds(inner, "since_edge", since_edge, limit)),
            self.lemma.pulses.eq(
                Mux(
                    strobes.latches,
                    (counted == self.at_strobe["pulses"]) & (pulses == 0),
                    counted == _at_most(full, pulses),
                )
            ),
            self.lemma.period.eq(
                (inner["sensor_0.period.begun"] == begun) & (inner["sensor_0.period"] == period)
            ),
            self.lemma.flag.eq(
                (~due_at_strobe | _saturated(flags))
                & Mux(strobes.latches, ~due, ~due | _saturated(live))
                & ((pulses <= full) | due)
            ),
            self.lemma.carried.eq(carried),
            self.holds.eq(told & (strobes.busy | ~due_at_strobe | _saturated(out))),
            self.reached.eq(strobes.delivers & ((inner["sensor.0.period"] != 0) | _saturated(out))),
        ]
        return m


def _at_most(limit: int, count: Value) -> Value:
    return Mux(count > limit, limit, count)


def _binds(inner: Internals, name: str, since: Value, limit: int) -> Value:
    """The invariant between ticks since an event and the gateware's register of them."""
    register, started = inner[f"sensor_0.{name}.ticks"], inner[f"sensor_0.{name}.started"]
    expected = Mux(since > limit, limit, Mux(started, since - 1, 0))
    return (register == expected) & (started == (since != 0))


def _saturated(flags: Value) -> Value:
    return (flags & Flag.SATURATED).any()


def _mutant(name: str, old: str, new: str, file: str, rejected: Run | Search = READ) -> Mutant:
    return Mutant(name, f"railgate.odometer.gateware.{file}", old, new, rejected)


def _bouncing() -> Trace:
    """More edges of A than 8 bits can count and a read; then a rest, and a read again."""
    ticks = range(0, FULL - 102, 2)  # the last is a fall, which voids the window
    a = Waveform.of(ticks, [i % 2 for i in range(len(ticks))])
    reads = FULL - 97, FULL - 40
    changes = [0, *(tick + more for tick in reads for more in range(2))]
    strobe = Waveform.of(changes, [i % 2 for i in range(len(changes))])
    return Trace({"a": a, "strobe": strobe}, TICK, 0, FULL)


_SHALLOW = (
    _mutant(
        "restarts-at-one",
        "Mux(self.restart, 0, self.now)",
        "Mux(self.restart, 1, self.now)",
        "steps",
    ),
    _mutant(
        "edges-of-a-only",
        "since_edge.restart.eq(a_edge | b_edge)",
        "since_edge.restart.eq(a_edge)",
        "sensor",
    ),
    _mutant(
        "never-restarts", "since_rise.restart.eq(a.rise)", "since_rise.restart.eq(0)", "sensor"
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
        method=Induction(),
        cover=READ,
        mutants=_SHALLOW,
    ),
    Claim(
        name="odometer.saturation-scaled",
        claim=(
            f"{_CLAIM} (sensor 0; scaled, so that mutants meet the limits: period_bits = 5, "
            "count_bits = 8)."
        ),
        requirements=("ODO-2", "ODO-6", "ODO-11", "ODO-12"),
        monitor=partial(_Saturation, SMALL),
        method=Induction(),
        cover=READ,
        mutants=(
            _mutant(
                "wraps",
                "Mux(full, self._limit, self.ticks + started)",
                "self.ticks + started",
                "steps",
                _DEEP,
            ),
            _mutant(
                "untold",
                "since_rise.reaches | window.saturated",
                "window.saturated",
                "sensor",
                _DEEP,
            ),
            _mutant(
                "pulses-wrap",
                "pulses + (a.rise & ~pulses_full)",
                "pulses + a.rise",
                "sensor",
                _DEEP,
            ),
            _mutant("pulses-untold", "| (a.rise & pulses_full)", "", "sensor", _DEEP),
        ),
    ),
)
