"""One output: its states follow the contract's table, and what that table is worth."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial

from amaranth.hdl import Cat, Module, Mux, Signal, Value

from railgate.proving import Claim, Induction, Internals, Monitor, Mutant, Run, Search
from railgate.vital_output.proofs.stimuli import SEARCH, Step, mutant, trace
from railgate.vital_output.spec import Code, Config, State
from railgate.waves import Trace

__all__ = ["ALARMS", "CLAIMS", "DEFAULT", "PULSING", "Watched", "among"]

DEFAULT = Config()
FLAGS = ("cmd", "fb", "frequency", "contact", "begins", "watching", "acknowledged", "upset")
ALARMS = (State.HANDSHAKE_ALARM, State.FEEDBACK_ALARM)
PULSING = (State.DRIVE, State.TEST)
Row = tuple[State, Value, State]


class Watched(Monitor):
    """An output whose inputs are free. `before`: its state in the tick before; `elapsed`: ticks in
    this state, up to a number above all that the contract holds it to; `starts_high`: a train that
    began with this state is 1."""

    def __init__(self, config: Config, lemmas: Iterable[str] = ()) -> None:
        super().__init__(
            {"peer_code": 2} | dict.fromkeys(FLAGS, 1), ("sound", "elapsed", "train", *lemmas)
        )
        self.config = config
        self.before = Signal(State)
        self.starts_high = Signal()
        self.elapsed = Signal(range(2 * max(config.release_ticks, config.test_ticks)))

    def output(self, m: Module) -> Internals:
        """Adds it, and what binds it to `elapsed`."""
        from railgate.vital_output.gateware.output import Output

        m.submodules.dut = inner = Internals(dut := Output(self.config))
        m.d.comb += [getattr(dut, name).eq(getattr(self, name)) for name in FLAGS]
        m.d.comb += dut.peer_code.eq(self.peer_code)
        period = self.config.period_ticks
        ticks, phase = Signal.like(self.elapsed), Signal(range(period))
        enters = dut.state != self.before
        phase_now = Mux(enters, 0, phase)
        m.d.comb += [
            self.elapsed.eq(Mux(enters, 0, ticks)),
            self.starts_high.eq(phase_now < self.config.half_period_ticks),
        ]
        m.d.sync += [
            self.before.eq(dut.state),
            ticks.eq(self.elapsed + ~self.elapsed.all()),
            phase.eq(Mux(phase_now == period - 1, 0, phase_now + 1)),
        ]
        most = self._limit()
        m.d.comb += [
            self.lemma.sound.eq(~inner["error"]),
            self.lemma.elapsed.eq(
                inner["held_elapsed.value"] == Mux(self.elapsed > most, most, self.elapsed)
            ),
            self.lemma.train.eq((inner["phase"] == phase_now) & (phase < period)),
        ]
        return inner

    def _limit(self) -> int:
        """What elapsed is held to at most."""
        config = self.config
        return max(
            config.tau1_ticks,
            config.not_yet_driving_ticks,
            config.pulse_grace_ticks,
            config.pick_up_ticks,
            config.skew_ticks,
            config.release_ticks,
            config.test_ticks,
        )


class _Table(Watched):
    """The next state is that of the first row of the contract's table that applies, else the same;
    `reached` once each row has applied."""

    def __init__(self, config: Config) -> None:
        super().__init__(config, ("left",))

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.output(m)
        state, left = inner["state"], Signal()
        following, expected, pulse = Signal(State), Signal(State), Signal()
        rows = self._rows(left)
        seen = Signal(len(rows))
        m.d.comb += following.eq(state)
        m.d.sync += [
            expected.eq(following),
            left.eq((state == State.WAIT) & left & self.cmd),
            pulse.eq(among(state, PULSING) & self.starts_high & ~self.upset),
        ]
        taken: Value = Signal()
        for number, (of, condition, to) in enumerate(rows):
            applies = (state == of) & condition
            first = Signal(name=f"row_{number}")
            m.d.comb += first.eq(applies & ~taken)
            taken = taken | applies
            with m.If(first):
                m.d.comb += following.eq(to)
                m.d.sync += seen[number].eq(1)
        with m.If((state == State.DRIVE) & self.cmd & (self.peer_code == Code.OFF)):
            m.d.sync += left.eq(1)
        m.d.comb += [
            self.lemma.left.eq((state != State.WAIT) | (inner["left"] == left)),
            self.holds.eq(
                (state == expected)
                & (inner["pulse"] == pulse)
                & (inner["code"] == _code(state))
                & Cat(
                    inner[event] == ((state != to) & (following == to))
                    for event, to in zip(("handshake_alarm", "feedback_alarm"), ALARMS, strict=True)
                ).all()
            ),
            self.reached.eq(seen.all()),
        ]
        return m

    def _rows(self, left: Value) -> list[Row]:
        """From, condition, to: "Drive" in spec, line by line."""
        config, elapsed, peer = self.config, self.elapsed, self.peer_code
        alarm, wrong = ALARMS
        off, not_yet = peer == Code.OFF, peer == Code.PRE_DRIVE
        return [
            (State.IDLE, self.watching & self.fb, wrong),
            (State.IDLE, self.fb, State.WAIT),
            (State.IDLE, self.begins, State.TEST),
            (State.IDLE, self.cmd, State.PRE_DRIVE),
            (State.PRE_DRIVE, ~self.cmd, State.IDLE),
            (State.PRE_DRIVE, self.fb, State.WAIT),
            (State.PRE_DRIVE, not_yet | (peer == Code.DRIVE), State.DRIVE),
            (State.PRE_DRIVE, elapsed >= config.tau1_ticks - 1, alarm),
            (State.DRIVE, ~self.cmd, State.WAIT),
            (State.DRIVE, peer == Code.ALARM, alarm),
            (State.DRIVE, off, State.WAIT),
            (State.DRIVE, not_yet & (elapsed >= config.not_yet_driving_ticks), alarm),
            (State.DRIVE, (elapsed >= config.pulse_grace_ticks) & ~self.frequency, wrong),
            (State.DRIVE, (elapsed >= config.pick_up_ticks) & ~self.contact, wrong),
            (State.WAIT, left & self.cmd & (elapsed >= config.skew_ticks), alarm),
            (State.WAIT, ~self.fb & ~(left & self.cmd), State.IDLE),
            (State.WAIT, self.fb & (elapsed >= config.release_ticks), wrong),
            (State.TEST, self.contact, wrong),
            (State.TEST, (elapsed >= config.test_ticks - 1) & self.frequency, State.WAIT),
            (State.TEST, elapsed >= config.test_ticks - 1, wrong),
            (alarm, ~self.cmd & ~self.fb, State.IDLE),
            (wrong, self.acknowledged & ~self.cmd & ~self.fb, State.IDLE),
        ]


def _all_rows() -> Trace:
    """Takes an output of the default configuration through all rows of the table, in their times
    where they have one."""
    config = DEFAULT
    ready, cleared = (2, {"cmd": 1}), (4, {"acknowledged": 1})
    agreed = {"cmd": 1, "peer_code": Code.DRIVE}
    driving = (ready, (3, agreed))
    not_yet = {"cmd": 1, "peer_code": Code.PRE_DRIVE}
    test = (1, {"begins": 1})
    idle: Step = (4, {})
    steps: tuple[Step, ...] = (
        *((1, {"watching": 1, "fb": 1}), cleared),
        *((2, {"fb": 1}), idle),
        *((2, {"fb": 1}), (config.release_ticks + 4, {"fb": 1}), cleared),
        *(test, (2, {"contact": 1}), cleared),
        *(test, (config.test_ticks + 4, {"frequency": 1})),
        *(test, (config.test_ticks + 4, {}), cleared),
        *(ready, idle),
        *(ready, (2, {"cmd": 1, "fb": 1}), idle),
        *((config.tau1_ticks + 4, {"cmd": 1}), idle),
        *(*driving, idle),
        *(ready, (config.not_yet_driving_ticks + 4, not_yet), idle),
        *(*driving, (2, {"cmd": 1, "peer_code": Code.ALARM}), idle),
        *(*driving, (config.skew_ticks + 4, {"cmd": 1}), idle),
        *(*driving, (2, {"cmd": 1}), (1, {"fb": 1})),
        *((config.skew_ticks + 4, {"cmd": 1, "fb": 1}), idle),
        *(*driving, (config.pulse_grace_ticks + 4, agreed), cleared),
        *(*driving, (config.pick_up_ticks + 4, {"frequency": 1} | agreed), cleared),
    )
    return trace({"peer_code": 2} | dict.fromkeys(FLAGS, 1), steps)


ALL_ROWS = Run(_all_rows().end, _all_rows)


def among(state: Value, states: Iterable[State]) -> Value:
    return Cat(state == each for each in states).any()


def _code(state: Value) -> Value:
    """What the peer is told of it."""
    alarm = Mux(among(state, ALARMS), Code.ALARM, Code.OFF)
    return Mux(
        state == State.PRE_DRIVE,
        Code.PRE_DRIVE,
        Mux(state == State.DRIVE, Code.DRIVE, alarm),
    )


def _mutant(name: str, old: str, new: str, rejected: Search | Run = SEARCH) -> Mutant:
    return mutant(name, "output", old, new, rejected)


CLAIMS = (
    Claim(
        name="vital_output.output-table",
        claim=(
            "For ever and whatever comes in, an output's next state is the one that the first row "
            "of the contract's table that applies names, and its pulse, its code and its events "
            "are those of its state; each of the 22 rows applies at some time: no state is "
            "out of reach or without a way out (default configuration)."
        ),
        requirements=("DRV-8", "DRV-9", "DRV-10", "DRV-11", "DRV-12", "DRV-18"),
        monitor=partial(_Table, DEFAULT),
        fast=False,
        method=Induction(),
        cover=ALL_ROWS,
        mutants=(
            _mutant("tau1-a-tick-longer", "config.tau1_ticks - 1", "config.tau1_ticks", ALL_ROWS),
            _mutant(
                "not-yet-a-tick-longer",
                "elapsed >= config.not_yet",
                "elapsed > config.not_yet",
                ALL_ROWS,
            ),
            _mutant(
                "grace-a-tick-longer",
                "elapsed >= config.pulse_g",
                "elapsed > config.pulse_g",
                ALL_ROWS,
            ),
            _mutant(
                "pick-up-a-tick-longer", "elapsed >= config.pick", "elapsed > config.pick", ALL_ROWS
            ),
            _mutant(
                "skew-a-tick-longer", "elapsed >= config.skew", "elapsed > config.skew", ALL_ROWS
            ),
            _mutant(
                "release-a-tick-longer", "elapsed >= config.rel", "elapsed > config.rel", ALL_ROWS
            ),
            _mutant("test-a-tick-longer", "config.test_ticks - 1", "config.test_ticks", ALL_ROWS),
            _mutant(
                "left-stays", "m.d.sync += left.eq(stays)", "m.d.sync += left.eq(left)", ALL_ROWS
            ),
            _mutant(
                "welded-unseen",
                "self.fb & (elapsed >= config.release",
                "(elapsed < 0) & (elapsed >= config.release",
                ALL_ROWS,
            ),
        ),
    ),
)
