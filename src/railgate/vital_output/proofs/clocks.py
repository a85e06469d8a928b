"""The peer's clock: never found off within tolerance, beyond the limit always in its time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from math import ceil
from typing import Any

from amaranth.hdl import Module, Mux, Shape, Signal, Value, signed

from railgate.proving import Claim, Induction, Internals, Monitor, Mutant, Run
from railgate.vital_output.proofs.stimuli import Step, mutant, trace
from railgate.vital_output.spec import Config
from railgate.waves import Trace

__all__ = ["CLAIMS"]

JITTER = 2
"""A message is taken up to so many ticks later than its sender's clock alone has it."""
MOST_STEPS = 3
INPUTS = {"taken": 1, "step": 2, "jitter": 2, "loses": 1}
WAY = {"begins": 1, "fast": 1}


class _Short(Config):
    """A window of few messages and a short period; limit and lost link in about their ratios."""

    link_period_ticks = 64
    drift_limit_ticks = 8
    lost_ticks = 7 * link_period_ticks // 2
    drift_detection_ticks = 2 * (16 + MOST_STEPS) * link_period_ticks

    def __post_init__(self) -> None:
        """What holds between the fields does not matter."""


SHORT = _Short(window_messages=16)


@dataclass(frozen=True)
class _Drift:
    """How drift is counted: in 2^-fraction_bits ticks, `parts` of which make a message late."""

    config: Config
    fraction_bits: int
    parts: int

    @property
    def shape(self) -> Shape:
        """Of a message's drift: three periods, either way."""
        most = self.config.link_period_ticks * MOST_STEPS << self.fraction_bits
        return signed(most.bit_length() + 1)


def _per_message(config: Config, fraction_bits: int, ticks: Fraction) -> _Drift:
    return _Drift(config, fraction_bits, ceil(ticks * (1 << fraction_bits)))


DEFAULT = Config()
TOLERATED = _per_message(
    DEFAULT, 10, Fraction(DEFAULT.link_period_ticks * DEFAULT.drift_ppm, 1_000_000)
)
BEYOND = _per_message(SHORT, 4, Fraction(SHORT.drift_limit_ticks + 4, SHORT.window_messages))


class _Measured(Monitor):
    """An oscillator's measure, and messages that come as their sender's clock and the line have it.

    taken, step: in, 1 and 2 bits, a message is taken, so many numbers after the one before. drift:
    in, signed, in 2^-fraction_bits ticks, how much later that is than by equal clocks. jitter: in,
    2 bits, ticks that it is late besides. loses: in, 1 bit, the link is lost; so it is in any case
    after lost_ticks. Assumed is that as many ticks are between messages as these tell.
    """

    def __init__(self, drift: _Drift, inputs: Mapping[str, int]) -> None:
        config = drift.config
        self.config, self.fraction_bits, self.parts = config, drift.fraction_bits, drift.parts
        super().__init__(
            {**INPUTS, "drift": drift.shape, **inputs}, ("measures", "ranges", "bound")
        )
        self.since = Signal(range(config.lost_ticks + 1), init=1)  # ticks since the last message
        self.linked, self.window = Signal(), Signal(range(config.window_messages))
        # Since the window's first message: by how much the last one was late, and the next one is.
        lag = signed(drift.shape.width + 2)
        self.lag, self.lag_now = Signal(lag, name="lag"), Signal(lag, name="lag_now")
        self.late_first, self.late_last = Signal(2), Signal(2)
        self.ends = Signal()  # the window, with the message of this tick

    def oscillator(self, m: Module) -> Internals:
        """Adds it, with the link, and what binds it to lags."""
        from railgate.vital_output.gateware.oscillator import Oscillator

        config, period = self.config, self.config.link_period_ticks
        m.submodules.dut = inner = Internals(dut := Oscillator(config))
        m.d.comb += [
            dut.linked.eq(self.linked),
            dut.taken.eq(self.taken),
            dut.step.eq(self.step),
            self.lag_now.eq(self.lag + self.drift),
        ]
        off = self.ticks(self.lag_now) + self.jitter - self.late_first
        over = (off > config.drift_limit_ticks) | (off < -config.drift_limit_ticks)
        full = self.window + self.step >= config.window_messages
        m.d.comb += self.ends.eq(self.taken & (~self.linked | over | full))
        silent = self.since == config.lost_ticks
        m.d.sync += self.since.eq(Mux(self.taken, 1, self.since + ~silent))
        with m.If(self.taken):
            m.d.sync += [
                self.linked.eq(1),
                self.window.eq(Mux(self.ends, 0, self.window + self.step)),
                self.lag.eq(Mux(self.ends, self.lag_now[: self.fraction_bits], self.lag_now)),
                self.late_last.eq(self.jitter),
            ]
            with m.If(self.ends):
                m.d.sync += self.late_first.eq(self.jitter)
        with m.Elif(self.loses | silent):
            m.d.sync += self.linked.eq(0)

        later = self.ticks(self.lag_now) - self.ticks(self.lag) + self.jitter - self.late_last
        due = self.since == self.step * period + later
        m.d.comb += [
            self.assumed.eq(
                (self.jitter <= JITTER)
                & (~(self.linked & self.taken) | ((self.step != 0) & due & self.drifts()))
            ),
            self.lemma.measures.eq(
                (inner["window"] == self.window)
                & (~self.linked | (inner["offset"] == self.shift() + self.since - 1))
            ),
            self.lemma.ranges.eq(
                (self.since >= 1)
                & (self.since <= config.lost_ticks)
                & (self.late_last <= JITTER)
                & (self.late_first <= JITTER)
            ),
        ]
        return inner

    def ticks(self, lag: Value) -> Value:
        return lag >> self.fraction_bits

    def shift(self) -> Value:
        """Ticks that the last message came late, since the window's first."""
        return self.ticks(self.lag) + self.late_last - self.late_first

    def drifts(self) -> Value:
        """What is assumed of the drift of a message."""
        raise NotImplementedError


class _Within(_Measured):
    """Clocks within their tolerance: the peer's is never found off."""

    def __init__(self) -> None:
        super().__init__(TOLERATED, {})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.oscillator(m)
        most = self.window * self.parts
        above = most + (1 << self.fraction_bits)
        m.d.comb += [
            self.lemma.bound.eq(~self.linked | ((self.lag >= -most) & (self.lag < above))),
            self.holds.eq(~inner["off_frequency"] & ~inner["drifting"]),
            self.reached.eq(self.ends & (self.shift() > self.config.drift_limit_ticks // 2)),
        ]
        return m

    def drifts(self) -> Value:
        most = self.step * self.parts
        return (self.drift >= -most) & (self.drift <= most)


class _Beyond(_Measured):
    """A clock that is off from some tick on is found, and stays found while its messages come.

    begins: in, 1 bit, it is off from this tick on. fast: in, 1 bit, in that tick: which way.
    """

    def __init__(self) -> None:
        super().__init__(BEYOND, WAY)
        self.off, self.early = Signal(), Signal()

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.oscillator(m)
        declared, limit = SHORT.drift_detection_ticks, SHORT.drift_limit_ticks
        ticks = Signal(range(2 * declared))  # linked, and it is off
        only = Signal()  # it was throughout this window
        with m.If(self.begins & ~self.off):
            m.d.sync += [self.off.eq(1), self.early.eq(self.fast)]
        m.d.sync += ticks.eq(Mux(self.linked, ticks + (self.off & ~ticks.all()), 0))
        with m.If(self.ends & self.off):
            m.d.sync += only.eq(1)

        drifting, behind = inner["drifting"], self.window * self.parts
        here = self.since + self.window * SHORT.link_period_ticks + self.shift()
        window = (SHORT.window_messages + MOST_STEPS - 1) * SHORT.link_period_ticks
        m.d.comb += [
            self.lemma.bound.eq(
                (self.off | (~only & (ticks == 0)))
                & (
                    ~self.linked
                    | (self.shift() >= -limit)
                    & (self.shift() <= limit)
                    & (only | (ticks <= here + limit))
                    & (~only | drifting | (ticks <= window + 2 * limit + here))
                    & (
                        ~only
                        | Mux(
                            self.early,
                            self.lag < (1 << self.fraction_bits) - behind,
                            self.lag >= behind,
                        )
                    )
                )
            ),
            self.holds.eq(drifting | ~self.linked | (ticks <= declared)),
            self.reached.eq(self.linked & drifting & (ticks > declared)),
        ]
        return m

    def drifts(self) -> Value:
        least = self.step * self.parts
        off = Mux(self.early, self.drift <= -least, self.drift >= least)
        return ~self.off | off


def _messages(drift: _Drift, windows: int, way: Mapping[str, int] | None = None) -> Trace:
    """Messages over so many windows and a bit, each one later by its drift; way: of a clock that
    is off from the first tick on."""
    sign = -1 if way and way["fast"] else 1
    late = [sign * drift.parts * number >> drift.fraction_bits for number in range(1 << 15)]
    steps: list[Step] = [(1, {"taken": 1, "step": 1, **(way or {})})]
    for number in range(windows * drift.config.window_messages + MOST_STEPS):
        ticks = drift.config.link_period_ticks + late[number + 1] - late[number]
        steps += [(ticks - 1, {}), (1, {"taken": 1, "step": 1, "drift": sign * drift.parts})]
    return trace({**INPUTS, "drift": drift.shape, **(WAY if way else {})}, steps)


def _run(*arguments: Any) -> Run:
    return Run(_messages(*arguments).end, partial(_messages, *arguments))


WITHIN = _run(TOLERATED, 2)
SLOW, FAST = (_run(BEYOND, 3, {"begins": 1, "fast": fast}) for fast in (0, 1))


def _mutant(name: str, old: str, new: str, rejected: Run) -> Mutant:
    return mutant(name, "oscillator", old, new, rejected)


CLAIMS = (
    Claim(
        name="vital_output.clock-within",
        claim=(
            "For ever, while two clocks are within their tolerance, 200 ppm from one another, and "
            f"a message is up to {JITTER} ticks late by line and receiver, the peer's clock is "
            "never found off, whichever messages are lost, and however often the link is (default "
            "configuration; drift in 1/1024 of a tick)."
        ),
        requirements=("DRV-14", "DRV-17"),
        monitor=_Within,
        fast=False,
        method=Induction(),
        cover=WITHIN,
        mutants=(
            _mutant(
                "half-the-limit",
                "limit, period = config.drift_limit_ticks,",
                "limit, period = config.drift_limit_ticks // 2,",
                WITHIN,
            ),
            _mutant("a-tick-a-message", "steps * period - 1", "steps * period - 2", WITHIN),
            _mutant(
                "adds-up-windows",
                "m.d.sync += [offset.eq(0), window.eq(0)]",
                "m.d.sync += window.eq(0)",
                WITHIN,
            ),
        ),
    ),
    Claim(
        name="vital_output.clock-beyond",
        claim=(
            "For ever, a clock that is off either way by 4 ticks in a window more than the limit, "
            "or more, from any tick on, is found off within drift_detection_ticks of the link's "
            "time, or the link is lost, and it stays found while messages come, whichever of them "
            f"are lost ({SHORT.link_period_ticks} ticks from message to message, "
            f"{SHORT.window_messages} in a window, limit {SHORT.drift_limit_ticks} ticks, "
            f"lost_ticks {SHORT.lost_ticks}, drift_detection_ticks {SHORT.drift_detection_ticks}, "
            f"a message up to {JITTER} ticks late, drift in 1/16 of a tick)."
        ),
        requirements=("DRV-17",),
        monitor=_Beyond,
        method=Induction(),
        cover=SLOW,
        mutants=(
            _mutant("slow-alone", " | (offset < span - limit)", "", FAST),
            _mutant(
                "half-a-window",
                ">= config.window_messages)",
                ">= config.window_messages // 2)",
                SLOW,
            ),
            _mutant(
                "forgets",
                "with m.Elif(self.linked & self.taken & passes):",
                "with m.Elif(self.linked & self.taken):",
                SLOW,
            ),
        ),
    ),
)
