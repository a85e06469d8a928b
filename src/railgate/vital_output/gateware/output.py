"""One output: its state, its pulse train, and what the peer is told of it."""

from __future__ import annotations

from amaranth.hdl import Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.primitives import SparseState, Twin
from railgate.vital_output.spec import Code, Config, State

__all__ = ["Output"]


class Output(wiring.Component):
    """Drives one relay together with the peer's same output.

    cmd: in, 1 bit, it shall drive. peer_code: in, see Code, OFF without a peer. fb, frequency,
    contact: in, 1 bit each, see Feedback. begins, watching: in, 1 bit each, see Shutoff.
    acknowledged: in, 1 bit, event. upset: in, 1 bit, something that all outputs share is.
    state: out, see State. code: out, see Code, what the peer is told of it. pulse: out, 1 bit,
    register, the pin. handshake_alarm, feedback_alarm: out, 1 bit each, events, it enters this
    state. error: out, 1 bit, state or elapsed are upset; the next state is FEEDBACK_ALARM.
    Requirements DRV-8 … DRV-12, DRV-18.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        flags = ("cmd", "fb", "frequency", "contact", "begins", "watching", "acknowledged", "upset")
        outputs = ("pulse", "handshake_alarm", "feedback_alarm", "error")
        super().__init__(
            {name: In(1) for name in flags}
            | {"peer_code": In(Code), "state": Out(State), "code": Out(Code)}
            | {name: Out(1) for name in outputs}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config = self._config
        following = Signal(State)
        state, elapsed = self._hold(m, following)
        left = Signal()  # in WAIT, because the peer was the first to leave
        peer_in_pre_drive = self.peer_code == Code.PRE_DRIVE
        peer_in_drive = self.peer_code == Code.DRIVE

        m.d.comb += following.eq(state)
        m.d.sync += left.eq(0)
        with m.Switch(state):
            with m.Case(State.IDLE):
                with m.If(self.watching & self.fb):
                    m.d.comb += following.eq(State.FEEDBACK_ALARM)
                with m.Elif(self.fb):
                    m.d.comb += following.eq(State.WAIT)
                with m.Elif(self.begins):
                    m.d.comb += following.eq(State.TEST)
                with m.Elif(self.cmd):
                    m.d.comb += following.eq(State.PRE_DRIVE)
            with m.Case(State.PRE_DRIVE):
                with m.If(~self.cmd):
                    m.d.comb += following.eq(State.IDLE)
                with m.Elif(self.fb):
                    m.d.comb += following.eq(State.WAIT)
                with m.Elif(peer_in_pre_drive | peer_in_drive):
                    m.d.comb += following.eq(State.DRIVE)
                with m.Elif(elapsed >= config.tau1_ticks - 1):
                    m.d.comb += following.eq(State.HANDSHAKE_ALARM)
            with m.Case(State.DRIVE):
                with m.If(~self.cmd):
                    m.d.comb += following.eq(State.WAIT)
                with m.Elif(self.peer_code == Code.ALARM):
                    m.d.comb += following.eq(State.HANDSHAKE_ALARM)
                with m.Elif(self.peer_code == Code.OFF):
                    m.d.comb += following.eq(State.WAIT)
                    m.d.sync += left.eq(1)
                with m.Elif(peer_in_pre_drive & (elapsed >= config.not_yet_driving_ticks)):
                    m.d.comb += following.eq(State.HANDSHAKE_ALARM)
                with m.Elif((elapsed >= config.pulse_grace_ticks) & ~self.frequency):
                    m.d.comb += following.eq(State.FEEDBACK_ALARM)
                with m.Elif((elapsed >= config.pick_up_ticks) & ~self.contact):
                    m.d.comb += following.eq(State.FEEDBACK_ALARM)
            with m.Case(State.WAIT):
                stays = left & self.cmd
                m.d.sync += left.eq(stays)
                with m.If(stays & (elapsed >= config.skew_ticks)):
                    m.d.comb += following.eq(State.HANDSHAKE_ALARM)
                with m.Elif(~self.fb & ~stays):
                    m.d.comb += following.eq(State.IDLE)
                with m.Elif(self.fb & (elapsed >= config.release_ticks)):
                    m.d.comb += following.eq(State.FEEDBACK_ALARM)
            with m.Case(State.TEST):
                with m.If(self.contact):
                    m.d.comb += following.eq(State.FEEDBACK_ALARM)
                with m.Elif(elapsed >= config.test_ticks - 1):
                    ends = Mux(self.frequency, State.WAIT, State.FEEDBACK_ALARM)
                    m.d.comb += following.eq(ends)
            with m.Case(State.HANDSHAKE_ALARM), m.If(~self.cmd & ~self.fb):
                m.d.comb += following.eq(State.IDLE)
            with m.Case(State.FEEDBACK_ALARM), m.If(self.acknowledged & ~self.cmd & ~self.fb):
                m.d.comb += following.eq(State.IDLE)
        with m.If(self.error):
            m.d.comb += following.eq(State.FEEDBACK_ALARM)

        with m.Switch(self.state):
            with m.Case(State.PRE_DRIVE):
                m.d.comb += self.code.eq(Code.PRE_DRIVE)
            with m.Case(State.DRIVE):
                m.d.comb += self.code.eq(Code.DRIVE)
            with m.Case(State.HANDSHAKE_ALARM, State.FEEDBACK_ALARM):
                m.d.comb += self.code.eq(Code.ALARM)
            with m.Default():
                m.d.comb += self.code.eq(Code.OFF)
        return m

    def _hold(self, m: Module, following: Signal) -> tuple[Value, Value]:
        """State, IDLE where its code is none, and ticks since its first one; with both the train,
        whose phase is elapsed modulo the period."""
        config = self._config
        most = max(
            config.tau1_ticks,
            config.not_yet_driving_ticks,
            config.pulse_grace_ticks,
            config.pick_up_ticks,
            config.skew_ticks,
            config.release_ticks,
            config.test_ticks,
        )
        m.submodules.held_state = state = SparseState(State, State.IDLE)
        m.submodules.held_elapsed = elapsed = Twin(most.bit_length())
        phase = Signal(range(config.period_ticks))
        changes = Signal()
        m.d.comb += [
            self.error.eq(state.error | elapsed.error),
            self.state.eq(Mux(state.error, State.FEEDBACK_ALARM, state.value)),
            state.next.eq(following),
            changes.eq(following != state.value),
            self.handshake_alarm.eq(changes & (following == State.HANDSHAKE_ALARM)),
            self.feedback_alarm.eq(changes & (following == State.FEEDBACK_ALARM)),
        ]
        m.d.sync += phase.eq(Mux(changes | (phase == config.period_ticks - 1), 0, phase + 1))
        with m.If(~(changes | self.error)):
            m.d.comb += elapsed.next.eq(elapsed.value + (elapsed.value != most))

        drives = (state.value == State.DRIVE) | (state.value == State.TEST)
        high = phase < config.half_period_ticks
        m.d.sync += self.pulse.eq(drives & high & ~self.error & ~self.upset)
        return state.value, elapsed.value
