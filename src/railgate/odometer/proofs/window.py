"""The measurement window: its periods, its ticks and its two sums are what they are defined as."""

from __future__ import annotations

from functools import partial

from amaranth.hdl import Cat, Module, Mux, Signal, Value

from railgate.odometer.proofs.contract import SMALL, Observed, ages_count, counts
from railgate.odometer.spec import Config
from railgate.proving import TICK, Claim, Induction, Internals, Mutant, Run, Search
from railgate.waves import Trace, Waveform

__all__ = ["CLAIMS"]

READ = Search(34)
"""Ticks from reset within which a window of several periods can be told."""

ROLLING = 400
"""Ticks of several windows of a rolling wheel."""


class _Window(Observed):
    """The window as the contract has it, by the ticks of its edges.

    After `window`: t, ticks from the boundary edge to this tick. adds, this tick's edge is one more
    of the window. starts, no edge before this tick counts. n, n_now: its periods before and after
    this tick's events.
    """

    def __init__(self, config: Config) -> None:
        super().__init__(config, ("boundary", "places", "live", "carried"))

    def window(self, m: Module, inner: Internals) -> dict[str, tuple[Value, Value]]:
        """Adds it; the fields after this tick's events, but for the sums."""
        limit, rise, opens = self.config.period_max, self.on_a.rise, self.strobes.opens
        # A window is voided before differences of these could be ambiguous.
        width = self.config.period_bits + 1
        tick, boundary, last = (Signal(width) for _ in range(3))
        seated, n = Signal(), Signal(self.config.window_bits)
        t = (tick - boundary)[:width]

        lost = seated & ((t == limit) | self.travel.reversal | self.travel.illegal)
        overflow = seated & ~lost & rise & (n == self.config.window_pulses)
        adds = Signal()
        starts = Signal()
        m.d.comb += [
            adds.eq(rise & seated & ~lost & ~overflow),
            starts.eq(~seated | lost | overflow),
        ]
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
        self.seated = seated

        moved = Signal()
        m.d.sync += moved.eq(rise & starts)
        since_last = (tick - last)[:width]
        m.d.comb += self.lemma.boundary.eq(
            (~self.on_a.begun | ages_count(inner))
            & (
                ~seated
                | (
                    (t <= limit)
                    & (t != 0)
                    & (moved | (inner["sensor_0.ages.boundary"] == t))
                    & (inner["sensor_0.ages.last"] == since_last)
                    & (since_last <= t)
                    & (since_last != 0)
                    & ((~self.strobes.latches & ~moved) | (boundary == last))
                    & ((n != 0) | (boundary == last))
                )
            )
        )

        places, most = inner["sensor_0.window.places"], self.config.window_pulses
        start = (1 << len(places)) - 1 - most
        used = (places - start)[: len(places)]
        in_use = Mux(self.strobes.latches, 0, inner["sensor_0.window.added"])
        m.d.comb += self.lemma.places.eq(
            (n <= most)
            & (inner["sensor_0.window.moves"] == moved)
            & (inner["sensor_0.window_seated"] == seated)
            & (
                ~self.on_a.begun
                | (
                    counts(inner, "sensor_0.window.places")
                    & counts(inner, "sensor_0.window.n")
                    & (~seated | moved | (used + in_use == n))
                )
            )
        )
        ticks = Mux(seated, (last - boundary)[:width], 0)
        return {
            "window_seated": (seated, seated_now),
            "window_n": (self.cleared("window_n", n), n_now),
            "window_ticks": (
                self.cleared("window_ticks", ticks),
                Mux(seated_now, (last_now - boundary_now)[:width], 0),
            ),
        }

    def tells(self, m: Module, inner: Internals, fields: dict[str, tuple[Value, Value]]) -> None:
        """The claim: snapshots tell the window's fields."""
        told, carried = self.reports(m, inner, fields)
        resting = Cat(
            *(before == 0 for name, (before, _) in fields.items() if name != "window_seated")
        ).all()
        m.d.comb += [
            self.lemma.live.eq(self.seated | resting | self.strobes.latches),
            self.lemma.carried.eq(carried),
            self.holds.eq(told & (self.n <= self.config.window_pulses)),
        ]


class _Edges(_Window):
    """Which edges are the window's, and the ticks between its first and its last one."""

    def __init__(self) -> None:
        super().__init__(Config())

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.odometer(m)
        self.tells(m, inner, self.window(m, inner))
        m.d.comb += self.reached.eq(self.strobes.delivers & (inner["sensor.0.window_n"] == 2))
        return m


class _Sums(_Window):
    """sum_a is the sum of all t_k, sum_b that of sum_a as it stood after each of them."""

    def __init__(self) -> None:
        super().__init__(Config())

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.odometer(m)
        fields = self.window(m, inner)

        total, nested = Signal(self.config.sum_a_bits), Signal(self.config.sum_b_bits)
        more = (total + self.t)[: len(total)]
        total_now = Mux(self.starts, 0, Mux(self.adds, more, total))
        nested_now = Mux(self.starts, 0, nested + Mux(self.adds, more, 0))
        m.d.sync += [
            total.eq(Mux(self.strobes.opens, 0, total_now)),
            nested.eq(Mux(self.strobes.opens, 0, nested_now)),
        ]
        fields |= {
            "sum_a": (self.cleared("sum_a", total), total_now),
            "sum_b": (self.cleared("sum_b", nested), nested_now),
        }
        self.tells(m, inner, fields)
        m.d.comb += self.reached.eq(self.strobes.delivers & (inner["sensor.0.window_n"] == 2))
        return m


class _LeastSquares(_Window):
    """sum_a = Σ t_k and sum_b = Σ (n + 1 - k) · t_k, as least squares have them.

    Written out, of all t_k of the window, k = 1 … n.
    """

    def __init__(self) -> None:
        super().__init__(SMALL)

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.odometer(m)
        fields = self.window(m, inner)

        count = self.config.window_pulses
        ticks = [Signal(self.config.period_bits, name=f"t_{k}") for k in range(1, count + 1)]
        ticks_now = []
        for k, tick in enumerate(ticks, 1):
            mine = self.adds & (self.n_now == k)
            ticks_now.append(Mux(mine, self.t, tick))
            m.d.sync += tick.eq(ticks_now[-1])

        before, after = self._sums(ticks, self.n), self._sums(ticks_now, self.n_now)
        fields |= {
            name: (self.cleared(name, before[name]), after[name]) for name in ("sum_a", "sum_b")
        }
        self.tells(m, inner, fields)
        m.d.comb += self.reached.eq(self.strobes.delivers & (inner["sensor.0.window_n"] == 2))
        return m

    def _sums(self, ticks: list[Value], n: Value) -> dict[str, Value]:
        sums: dict[str, Value] = {"sum_a": 0, "sum_b": 0}
        for last in range(1, len(ticks) + 1):
            terms = list(enumerate(ticks[:last], 1))
            total = sum(tick for _, tick in terms)
            weighted = sum((last + 1 - k) * tick for k, tick in terms)
            sums["sum_a"] = Mux(n == last, total, sums["sum_a"])
            sums["sum_b"] = Mux(n == last, weighted, sums["sum_b"])
        return sums


def _mutant(name: str, old: str, new: str, rejected: Run | Search = READ) -> Mutant:
    return Mutant(name, "railgate.odometer.gateware.window", old, new, rejected)


def _rolling(quarter: int) -> Trace:
    """A wheel that rolls forward at so many ticks a quarter period, read every 60 ticks."""

    def square(half: int, delay: int = 0) -> Waveform:
        ticks = [0, *range(half + delay, ROLLING, half)]
        return Waveform.of(ticks, [i % 2 for i in range(len(ticks))])

    waves = {"a": square(2 * quarter), "b": square(2 * quarter, quarter), "strobe": square(30)}
    return Trace(waves, TICK, 0, ROLLING)


_ROLLS = Run(ROLLING, partial(_rolling, 2))
_ROLLS_SLOWLY = Run(ROLLING, partial(_rolling, 3))
_ROLLS_FAST = Run(ROLLING, partial(_rolling, 1))
_SUM_BEFORE = _mutant("sum-before", "masked(m, sum_a, sums", "masked(m, delayed(m, sum_a, 1), sums")
_TICK_MISSING = _mutant("tick-missing", "ticks.eq(elapsed)", "ticks.eq(elapsed - 1)")

CLAIMS = (
    Claim(
        name="odometer.window",
        claim=(
            "In each snapshot window_n is the number of rising edges of A since the window's "
            "boundary edge, at most window_pulses, and window_ticks the ticks from it to the last "
            "of them; reversals, illegal transitions, saturation and overflow void the window, "
            "strobes move its boundary to its last edge (sensor 0; default configuration)."
        ),
        requirements=("ODO-10",),
        monitor=_Edges,
        method=Induction(14),
        cover=READ,
        mutants=(
            _TICK_MISSING,
            _mutant("reversal-stays", "kept = seated & ~self.broken", "kept = seated"),
            Mutant(
                "old-boundary",
                "railgate.odometer.gateware.sensor",
                "moves_soon.eq(latch_soon | window.moves)",
                "moves_soon.eq(window.moves)",
                _ROLLS,
            ),
        ),
        fast=False,
    ),
    Claim(
        name="odometer.sums",
        claim=(
            "In each snapshot sum_a is the sum of the ticks t_k from the window's boundary edge to "
            "each of its n edges, and sum_b the sum of sum_a as it was after each (sensor 0; "
            "default configuration, modulo their widths, which n edges cannot fill)."
        ),
        requirements=("ODO-10",),
        monitor=_Sums,
        method=Induction(14),
        cover=READ,
        mutants=(
            _SUM_BEFORE,
            _TICK_MISSING,
            _mutant("product", "skewed(m, t, SUM_BITS", "skewed(m, t << 1, SUM_BITS"),
        ),
        fast=False,
    ),
    Claim(
        name="odometer.sums-least-squares",
        claim=(
            "In each snapshot sum_b is the sum of (n + 1 - k) · t_k over k = 1 … n, so that "
            "6 · ((n + 2) · sum_a - 2 · sum_b) / (n · (n + 1) · (n + 2)) is the slope of the least "
            "squares through t_k, k = 0 … n (sensor 0; scaled: window_pulses = 3, "
            "period_bits = 5)."
        ),
        requirements=("ODO-10",),
        monitor=_LeastSquares,
        method=Induction(14),
        cover=READ,
        mutants=(
            _SUM_BEFORE,
            _mutant("edge-too-many", "& ~self.full & ~no_more\n", "& ~self.full\n", _ROLLS_FAST),
            _mutant(
                "edge-too-few",
                "init=most - config.window_pulses",
                "init=most - config.window_pulses + 1",
                _ROLLS,
            ),
            _mutant(
                "never-saturates",
                "full = self.full & ~self.moves",
                "full = self.full & 0",
                _ROLLS_SLOWLY,
            ),
        ),
        fast=False,
    ),
)
