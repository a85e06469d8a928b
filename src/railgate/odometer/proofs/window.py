"""The measurement window: its periods, its ticks and its two sums are what they are defined as."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal, Value

from railgate.odometer.proofs.contract import Observed
from railgate.odometer.spec import Config
from railgate.proving import Claim, Induction, Internals, Mutant, Search

__all__ = ["CLAIMS"]

READ = 26
"""Ticks from reset within which a window of several periods can be told."""

TICK_BITS = 64
"""Of the monitor's own tick."""

SHORT = Config(window_pulses=4, period_bits=18)
"""Otherwise the default: windows so short that their sums can be written out."""


class _Window(Observed):
    """The window as the contract has it, by the ticks of its edges.

    After `window`: t, ticks from the boundary edge to this tick. adds, this tick's edge is one more
    of the window. starts, no edge before this tick counts. n, n_now: its periods before and after
    this tick's events.
    """

    def __init__(self, config: Config, lemmas: tuple[str, ...]) -> None:
        super().__init__(config, ("boundary", "live", "carried", *lemmas))

    def window(self, m: Module, inner: Internals) -> dict[str, Value]:
        """Adds it; the fields after this tick's events, but for the sums."""
        limit, rise, opens = self.config.period_max, self.on_a.rise, self.strobes.opens
        tick, boundary, last = (Signal(TICK_BITS) for _ in range(3))
        seated, n = Signal(), Signal(self.config.window_bits)
        t = (tick - boundary)[:TICK_BITS]

        lost = seated & ((t == limit) | self.travel.reversal | self.travel.illegal)
        overflow = seated & ~lost & rise & (n == self.config.window_pulses)
        adds = Signal()
        starts = Signal()
        m.d.comb += [adds.eq(rise & seated & ~lost & ~overflow), starts.eq(~seated | lost | overflow)]
        seated_now = rise | (seated & ~lost)
        boundary_now = Mux(rise & starts, tick, boundary)
        last_now = Mux(rise, tick, last)
        n_now = Mux(starts, 0, n + adds)
        m.d.sync += [
            tick.eq(tick + 1),
            seated.eq(seated_now),
            last.eq(last_now),
            boundary.eq(Mux(opens, last_now, boundary_now)),
            n.eq(Mux(opens, 0, n_now)),
        ]
        self.t, self.n, self.n_now, self.adds, self.starts = t, n, n_now, adds, starts
        self.seated, self.ticks = seated, Mux(seated, last - boundary, 0)[:TICK_BITS]

        now = Mux(self.strobes.latches, inner["sensor_0.since_rise"], inner["sensor_0.window.elapsed"])
        m.d.comb += self.lemma.boundary.eq(
            ~seated
            | (
                (t <= limit)
                & (t != 0)
                & (now + 1 == t)
                & (inner["sensor_0.since_rise"] + 1 == (tick - last)[:TICK_BITS])
                & ((tick - last)[:TICK_BITS] <= t)
                & ((tick - last)[:TICK_BITS] != 0)
                & inner["sensor_0.since_rise.started"]
                & (~self.strobes.latches | (boundary == last))
                & ((n != 0) | (boundary == last))
            )
        )
        return {
            "window_seated": seated_now,
            "window_n": n_now,
            "window_ticks": Mux(seated_now, last_now - boundary_now, 0)[:TICK_BITS],
        }

    def tells(
        self, m: Module, inner: Internals, fields: dict[str, Value], sums: dict[str, Value]
    ) -> None:
        """The claim: snapshots tell the window's fields, of which `sums` are before this tick."""
        told, carried = self.reports(m, inner, fields)
        before = {"window_n": self.n, "window_ticks": self.ticks, **sums}
        names = ("window_seated", *before)
        live = [inner[f"sensor_0.{name}"] == before.get(name, self.seated) for name in names]
        latched = [inner[f"sensor_0.{name}"] == self.at_strobe[name] for name in names]
        rests = [value == 0 for value in before.values()]
        alone = self.seated == inner["sensor_0.window_seated"]
        m.d.comb += [
            self.lemma.live.eq(
                Mux(self.strobes.latches, Cat(*latched, *rests, alone).all(), Cat(*live).all())
                & (self.n <= self.config.window_pulses)
                & (self.seated | (self.n == 0))
            ),
            self.lemma.carried.eq(carried),
            self.holds.eq(told & (self.n <= self.config.window_pulses)),
        ]


class _Sums(_Window):
    """sum_a = Σ t_k, and sum_b = (n + 1) · Σ t_k - Σ k · t_k, as least squares have them.

    The products grow by addition: weighted = (n + 1) · t a tick's n + 1 at a time.
    """

    def __init__(self) -> None:
        super().__init__(Config(), ("sums",))

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.odometer(m)
        fields = self.window(m, inner)
        t, n = self.t, self.n

        width = self.config.sum_b_bits
        weighted, total, times_n, moments = (Signal(width) for _ in range(4))
        more, opens = self.adds, self.strobes.opens
        total_now = Mux(self.starts, 0, total + Mux(more, t, 0))
        moments_now = Mux(self.starts, 0, moments + Mux(more, weighted, 0))
        times_n_now = Mux(self.starts, 0, times_n + Mux(more, total + t + weighted, 0))
        m.d.sync += [
            total.eq(Mux(opens, 0, total_now)),
            moments.eq(Mux(opens, 0, moments_now)),
            times_n.eq(Mux(opens, 0, times_n_now)),
        ]
        return m
