"""The own time: it never steps back, its cycles keep their length, each is decided once."""

from __future__ import annotations

from functools import partial

from amaranth.hdl import Cat, Module, Mux, Signal, Value

from railgate.proving import Claim, Induction, Internals, Monitor, Mutant, Run, Search
from railgate.vital_output.proofs.stimuli import SEARCH, Step, mutant, trace
from railgate.vital_output.spec import Config
from railgate.waves import Trace

__all__ = ["CLAIMS"]

DEFAULT = Config()
INDEX_BITS = 32
FARTHEST = 1 << INDEX_BITS - 1
"""Cycles by which a seat takes the time ahead at most."""


class _Kept(Monitor):
    """A timekeeper whose updates are free, and the contract's `seated` beside it."""

    def __init__(self, *lemmas: str) -> None:
        config = DEFAULT
        super().__init__(
            {
                "valid": 1,
                "index_in": INDEX_BITS,
                "phase_in": range(config.cycle_ticks),
                "lifeless": 1,
            },
            ("seated", "pending", "phase", *lemmas),
        )
        self.config = config
        self.seated = Signal()

    def timekeeper(self, m: Module) -> tuple[Internals, Value, Value]:
        """Adds it; whether this tick's update is good, and whether it seats."""
        from railgate.vital_output.gateware.timekeeper import Timekeeper

        config = self.config
        cycle, margin, most = config.cycle_ticks, config.margin_ticks, config.slew_ticks
        m.submodules.dut = inner = Internals(dut := Timekeeper(config))
        m.d.comb += [
            getattr(dut, name).eq(getattr(self, name))
            for name in ("valid", "index_in", "phase_in", "lifeless")
        ]
        step = (self.index_in - dut.index)[:INDEX_BITS].as_signed()
        by = self.phase_in - dut.phase
        near = [
            (step == cycles) & (by + cycles * cycle >= -margin) & (by + cycles * cycle <= margin)
            for cycles in (-1, 0, 1)
        ]
        update = self.valid & (self.phase_in < cycle)
        good = update & self.seated & Cat(*near).any()
        ahead = (step > 0) | ((step == 0) & (by >= 0))
        seats = update & ~good & (~self.seated | (self.lifeless & ahead))
        m.d.sync += self.seated.eq(self.seated | seats)
        pending = inner["pending"]
        m.d.comb += [
            self.lemma.seated.eq(inner["seated"] == self.seated),
            self.lemma.pending.eq((pending >= -margin - most) & (pending <= margin + most)),
            self.lemma.phase.eq(dut.phase < cycle + most),
        ]
        return inner, good, seats


class _Forward(_Kept):
    """Once seated, every tick's time is ahead of the one before, by just a tick or the start of the
    next cycle where the network does not seat it; and it is trusted as the contract has it."""

    def __init__(self) -> None:
        super().__init__("agreed")

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner, good, seats = self.timekeeper(m)
        config, index, phase = self.config, inner["index"], inner["phase"]
        was_seated, was_index, was_phase = Signal(), Signal.like(index), Signal.like(phase)
        set_anew, agreed, confirmed = Signal(), Signal(), Signal()
        cycles, cycles_now = (Signal(range(config.holdover_cycles + 1)) for _ in range(2))
        m.d.sync += [
            was_seated.eq(self.seated),
            was_index.eq(index),
            was_phase.eq(phase),
            set_anew.eq(seats),
            confirmed.eq(good),
            cycles.eq(cycles_now),
        ]
        with m.If(self.valid & (self.phase_in < config.cycle_ticks)):
            m.d.sync += agreed.eq(good)
        step = (index - was_index)[:INDEX_BITS]
        next_cycle = (step == 1) & (phase == 0)
        older = next_cycle & (cycles != config.holdover_cycles)
        m.d.comb += [
            cycles_now.eq(Mux(confirmed | set_anew, 0, cycles + older)),
            self.lemma.agreed.eq(
                (inner["consistent"] == agreed) & (inner["holdover"] == cycles_now)
            ),
            self.holds.eq(
                (
                    ~was_seated
                    | Mux(
                        set_anew,
                        Mux(step == 0, phase > was_phase, step <= FARTHEST),
                        next_cycle | ((step == 0) & (phase == was_phase + 1)),
                    )
                )
                & (inner["trusted"] == (agreed & (cycles_now < config.holdover_cycles)))
            ),
            self.reached.eq(was_seated & set_anew & (step == 0)),
        ]
        return m


class _Cycles(_Kept):
    """A cycle in which the network does not seat the time lasts as long as it may, and is decided
    once; no cycle is decided twice."""

    def __init__(self) -> None:
        super().__init__("counted", "decided")

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner, _, seats = self.timekeeper(m)
        config, index, phase = self.config, inner["index"], inner["phase"]
        least = config.cycle_ticks - config.slew_ticks
        most = config.cycle_ticks + config.slew_ticks
        was, was_seated, set_anew = Signal.like(index), Signal(), Signal()
        whole, whole_now = Signal(init=1), Signal()
        ticks, ticks_now = (Signal(range(most + 2)) for _ in range(2))  # with this one
        decisions, decisions_now = Signal(2), Signal(2)
        m.d.sync += [
            was.eq(index),
            was_seated.eq(self.seated),
            set_anew.eq(seats),
            whole.eq(whole_now),
            ticks.eq(ticks_now),
            decisions.eq(decisions_now),
        ]
        begins = (index != was) & ~set_anew
        other = (index != was) | (set_anew & ~was_seated)
        m.d.comb += [
            whole_now.eq(begins | (whole & ~set_anew)),
            ticks_now.eq(Mux(begins, 1, ticks + 1)),
            decisions_now.eq(Mux(other, 0, decisions) + inner["decides"]),
            self.lemma.counted.eq(~whole_now | (ticks_now == phase + 1)),
            self.lemma.decided.eq(
                (decisions_now <= (phase >= config.decision_ticks))
                & (~whole_now | (decisions_now == (phase >= config.decision_ticks)))
            ),
            self.holds.eq(
                (
                    ~(begins & whole)
                    | ((ticks >= least) & (ticks <= most) & (decisions == 1) & (phase == 0))
                )
                & (decisions_now <= 1)
            ),
            self.reached.eq(begins & whole & (ticks == most)),
        ]
        return m


def _whole_cycles(ahead: int) -> Trace:
    """Two cycles, with an update soon after the first one's start that is ahead by so much."""
    cycle, margin = DEFAULT.cycle_ticks, DEFAULT.margin_ticks
    steps: tuple[Step, ...] = (
        (1, {"valid": 1}),
        (margin, {}),
        (1, {"valid": 1, "phase_in": margin + 1 + ahead}),
        (2 * cycle + margin, {}),
    )
    widths = {"valid": 1, "index_in": INDEX_BITS, "phase_in": (cycle - 1).bit_length()}
    return trace(widths | {"lifeless": 1}, steps)


def _run(ahead: int) -> Run:
    return Run(_whole_cycles(ahead).end, partial(_whole_cycles, ahead))


SLOW, FAST = _run(-DEFAULT.margin_ticks), _run(DEFAULT.margin_ticks)


def _mutant(name: str, old: str, new: str, rejected: Search | Run = SEARCH) -> Mutant:
    return mutant(name, "timekeeper", old, new, rejected)


CLAIMS = (
    Claim(
        name="vital_output.time-forward",
        claim=(
            "For ever and whatever the network tells, once the time is seated it is, in every "
            "tick, ahead of what it was (indices modulo 2³², a step of 2³¹ at most): by one tick "
            "or the start of the next cycle, or, without a life, by where the network seats it; "
            "and it is trusted just while the last update was a good one, holdover_cycles ago at "
            "most (default configuration)."
        ),
        requirements=("DRV-3",),
        monitor=_Forward,
        fast=False,
        method=Induction(),
        mutants=(
            _mutant(
                "seats-backwards", "(self.phase_in >= self.phase)", "(self.phase_in != self.phase)"
            ),
            _mutant("seats-while-alive", "(self.lifeless & later)", "later"),
            _mutant("margin-one-sided", "near.eq(~too_low & ~too_high)", "near.eq(~too_high)"),
            _mutant(
                "jump-is-trusted",
                "with m.If(self.jump):\n            m.d.sync += consistent.eq(0)",
                "with m.If(self.jump):\n            m.d.sync += seated.eq(1)",
                Search(6),
            ),
        ),
    ),
    Claim(
        name="vital_output.time-cycles",
        claim=(
            "For ever and whatever the network tells, a cycle in which it does not seat the time "
            "lasts cycle_ticks ± slew_ticks, begins with phase 0 and has exactly one decision; no "
            "cycle has two (default configuration)."
        ),
        requirements=("DRV-3", "DRV-7"),
        monitor=_Cycles,
        method=Induction(),
        cover=SLOW,
        mutants=(
            _mutant(
                "a-tick-more", "(self.phase >= last + slew)", "(self.phase > last + slew)", SLOW
            ),
            _mutant("slew-unlimited", "(self.phase >= last - slew)", "(self.phase >= 0)", FAST),
            _mutant(
                "decides-if-on-time",
                "self.decides.eq(self.phase == config.decision_ticks)",
                "self.decides.eq((self.phase == config.decision_ticks) & (pending >= 0))",
                SLOW,
            ),
        ),
    ),
)
