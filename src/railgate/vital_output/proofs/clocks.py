"""The peer's clock: found off tolerance in the declared time, never within tolerance."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import ceil

from amaranth.hdl import Module, Mux, Signal, Value, signed

from railgate.proving import Claim, Induction, Internals, Monitor, Mutant, Run, Search
from railgate.vital_output.proofs.stimuli import Step, mutant, trace
from railgate.vital_output.spec import Config
from railgate.waves import Trace

__all__ = ["CLAIMS"]

CONFIG = Config()
PERIOD, LIMIT, WINDOW = CONFIG.link_period_ticks, CONFIG.drift_limit_ticks, CONFIG.window_messages
MOST_STEPS = 3
FRACTION_BITS = 10
TICK = 1 << FRACTION_BITS
"""Drift is counted in so many parts of a tick."""
JITTER = 2
"""A message is taken up to so many ticks later than its sender's clock alone has it."""
TOLERATED = ceil(PERIOD * CONFIG.drift_ppm * TICK / 1_000_000)
"""Parts of a tick that a message is late or early by, of clocks within their tolerance."""
BEYOND = ceil((LIMIT + 4) * TICK / WINDOW)
"""The same, of a clock beyond the limit by 4 ticks in a window."""
DRIFT_BITS = (PERIOD * MOST_STEPS * TICK).bit_length() + 1
INPUTS = {"taken": 1, "step": 2, "jitter": 2, "loses": 1}


class _Measured(Monitor):
    """An oscillator's measure, and messages that come as their sender's clock and the line have it.

    taken, step: in, 1 and 2 bits, a message is taken, so many numbers after the one before. drift:
    in, signed, parts of a tick that it is later than that by nominal clocks. jitter: in, 2 bits,
    ticks that it is late besides. loses: in, 1 bit, the link is lost; so it is in any case after
    lost_ticks. Assumed is that the ticks between messages are what these tell.
    """

    def __init__(self, lemmas: Iterable[str], inputs: Mapping[str, int] | None = None) -> None:
        drift = {"drift": signed(DRIFT_BITS)}
        super().__init__({**INPUTS, **drift, **(inputs or {})}, ("measures", "ranges", *lemmas))
        reach = signed(DRIFT_BITS + 2)
        self.lag, self.lag_now = Signal(reach), Signal(reach)  # since the window's first message
        self.jitter_last, self.jitter_first = Signal(2), Signal(2)
        self.since = Signal(range(CONFIG.lost_ticks + 1), init=1)  # ticks since the last message
        self.window, self.linked, self.counted = Signal(range(WINDOW)), Signal(), Signal()

    def oscillator(self, m: Module) -> Internals:
        """Adds it. counted: a message is taken that tells of the clock."""
        from railgate.vital_output.gateware.oscillator import Oscillator

        m.submodules.dut = inner = Internals(dut := Oscillator(CONFIG))
        lost = self.linked & ~self.taken & (self.loses | (self.since == CONFIG.lost_ticks))
        m.d.comb += [
            *(dut.linked.eq(self.linked), dut.taken.eq(self.taken), dut.step.eq(self.step)),
            self.counted.eq(self.linked & self.taken),
            self.lag_now.eq(self.lag + self.drift),
        ]
        off = (self.lag_now >> FRACTION_BITS) + self.jitter - self.jitter_first
        self.over = (off > LIMIT) | (off < -LIMIT)
        self.ends = self.window + self.step >= WINDOW
        m.d.sync += self.since.eq(Mux(self.since == CONFIG.lost_ticks, self.since, self.since + 1))
        with m.If(lost):
            m.d.sync += self.linked.eq(0)
        with m.If(self.taken):
            m.d.sync += [self.linked.eq(1), self.since.eq(1), self.jitter_last.eq(self.jitter)]
            m.d.sync += [self.lag.eq(self.lag_now), self.window.eq(self.window + self.step)]
            with m.If(~self.linked | self.over | self.ends):
                m.d.sync += [
                    self.lag.eq(self.lag_now[:FRACTION_BITS]),
                    self.window.eq(0),
                    self.jitter_first.eq(self.jitter),
                ]
        spans = Mux(self.step == 1, PERIOD, Mux(self.step == 2, 2 * PERIOD, 3 * PERIOD))
        whole = self.lag >> FRACTION_BITS
        later = (self.lag_now >> FRACTION_BITS) - whole
        in_time = self.since == spans + later + self.jitter - self.jitter_last
        m.d.comb += [
            self.assumed.eq(
                (self.jitter <= JITTER)
                & (~self.counted | ((self.step != 0) & in_time & self._drifts()))
            ),
            self.lemma.measures.eq(
                (inner["window"] == self.window)
                & (
                    ~self.linked
                    | (
                        inner["offset"]
                        == whole + self.jitter_last - self.jitter_first + self.since - 1
                    )
                )
            ),
            self.lemma.ranges.eq(
                (self.since >= 1)
                & (self.since <= CONFIG.lost_ticks)
                & (self.jitter_last <= JITTER)
                & (self.jitter_first <= JITTER)
            ),
        ]
        return inner

    def _drifts(self) -> Value:
        """What is assumed of the drift of a message that counts."""
        raise NotImplementedError


class _Within(_Measured):
    """Within tolerance, no clock is ever found off."""

    def __init__(self) -> None:
        super().__init__(("bound",))

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.oscillator(m)
        most = self.window * TOLERATED
        m.d.comb += [
            self.lemma.bound.eq(
                ~self.linked | ((self.lag >= -most) & (self.lag < most + TICK))
            ),
            self.holds.eq(~inner["off_frequency"] & ~inner["drifting"]),
            self.reached.eq(self.counted & (self.lag > TOLERATED)),
        ]
        return m

    def _drifts(self) -> Value:
        most = self.step * TOLERATED
        return (self.drift >= -most) & (self.drift <= most)


class _Beyond(_Measured):
    """A clock that is off from some tick on is found, and stays found, while its messages come.

    begins: in, 1 bit, it is off from this tick on; fast: in, 1 bit, in that tick, which way.
    """

    def __init__(self) -> None:
        super().__init__(("bound",), {"begins": 1, "fast": 1})
        self.off, self.early = Signal(), Signal()

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.oscillator(m)
        declared = CONFIG.drift_detection_ticks
        ticks = Signal(range(2 * declared))  # linked, since it is off
        only = Signal()  # all of this window
        with m.If(self.begins & ~self.off):
            m.d.sync += [self.off.eq(1), self.early.eq(self.fast)]
        with m.If(self.off & self.linked):
            m.d.sync += ticks.eq(ticks + ~ticks.all())
        with m.If(~self.linked):
            m.d.sync += ticks.eq(0)
        with m.If(self.taken & self.off & (~self.linked | self.over | self.ends)):
            m.d.sync += only.eq(1)

        drifting, behind = inner["drifting"], self.window * BEYOND
        shifted = (self.lag >> FRACTION_BITS) + self.jitter_last - self.jitter_first
        here = self.since + self.window * PERIOD + shifted
        before = (WINDOW + MOST_STEPS - 1) * PERIOD + 2 * LIMIT
        m.d.comb += [
            self.lemma.bound.eq(
                (self.off | (~only & (ticks == 0)))
                & (
                    ~self.linked
                    | (shifted >= -LIMIT)
                    & (shifted <= LIMIT)
                    & (only | (ticks <= here + LIMIT))
                    & (~only | drifting | (ticks <= before + here))
                    & (~only | Mux(self.early, self.lag <= TICK - behind, self.lag >= behind))
                )
            ),
            self.holds.eq(drifting | ~self.linked | (ticks <= declared)),
            self.reached.eq(self.linked & only & drifting & (ticks > declared // 2)),
        ]
        return m

    def _drifts(self) -> Value:
        least = self.step * BEYOND
        return ~self.off | Mux(self.early, self.drift <= -least, self.drift >= least)


CLAIMS = (
    Claim(
        name="vital_output.clock-within",
        claim="x.",
        requirements=("DRV-17",),
        monitor=_Within,
        method=Induction(),
        cover=Run(10),
        mutants=(
            mutant("a","oscillator","a","b"),
            mutant("a2","oscillator","a","b"),
        ),
    ),
    Claim(
        name="vital_output.clock-beyond",
        claim="x.",
        requirements=("DRV-17",),
        monitor=_Beyond,
        method=Induction(),
        cover=Run(10),
        mutants=(
            mutant("a","oscillator","a","b"),
            mutant("a2","oscillator","a","b"),
        ),
    ),
)
