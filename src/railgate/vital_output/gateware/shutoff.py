"""The test of the shut-off paths: each channel pulses alone, and nothing else may move."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Signal
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from railgate.primitives import SparseState
from railgate.vital_output.spec import Config, State, TestPhase

__all__ = ["Shutoff"]

QUIET = (State.IDLE, State.HANDSHAKE_ALARM, State.FEEDBACK_ALARM)
BUSY = (State.TEST, State.WAIT)


class Shutoff(wiring.Component):
    """Brings the test forward, in turn with the peer's. FPGA 1, board 0, leads.

    states: in, a State an output. image: in, one bit an output. peer_ok, peer_test, booted: in, see
    LinkReceiver. test: in, 1 bit, a test is wanted.
    test_phase: out, see TestPhase. begins: out, 1 bit, event, the own test does. watching: out, 1
    bit, the peer pulses alone. both_done: out, 1 bit, neither FPGA wants or makes its test. error:
    out, 1 bit, the phase is upset; it is wanted anew. Requirement DRV-18.
    """

    def __init__(self, config: Config, board: int) -> None:
        self._leads = board == 0
        super().__init__(
            {
                "states": In(data.ArrayLayout(State, config.outputs)),
                "image": In(config.outputs),
                "peer_ok": In(1),
                "peer_test": In(TestPhase),
                "booted": In(1),
                "test": In(1),
                "test_phase": Out(TestPhase),
                "begins": Out(1),
                "watching": Out(1),
                "both_done": Out(1),
                "error": Out(1),
            }
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        # Where there is an error, `phase` is WANTED, the number 0.
        m.submodules.held_phase = held = SparseState(TestPhase, TestPhase.WANTED)
        phase, peer = held.value, self.peer_test
        quiet = self._each(QUIET).all()
        busy = self._each(BUSY).any()
        done = (phase == TestPhase.DONE) | (phase == TestPhase.REQUESTED)
        peer_done = (peer == TestPhase.DONE) | (peer == TestPhase.REQUESTED)
        peer_wants = peer == TestPhase.WANTED
        peer_runs = peer == TestPhase.RUNNING
        if self._leads:
            in_turn = peer_wants
            anew = self.booted
            asked = self.test | (self.peer_ok & (peer == TestPhase.REQUESTED))
            granted = (phase == TestPhase.REQUESTED) & quiet & (self.image == 0)
        else:
            in_turn = peer_done
            anew = self.peer_ok & (peer_wants | peer_runs)
            asked = self.test
            granted = 0

        following = held.next
        wanted = (phase == TestPhase.WANTED) & ~held.error
        m.d.comb += [
            self.test_phase.eq(phase),
            self.begins.eq(wanted & quiet & self.peer_ok & in_turn),
            self.watching.eq(self.peer_ok & peer_runs),
            self.both_done.eq(done & peer_done),
            self.error.eq(held.error),
            following.eq(phase),
        ]
        with m.If(self.begins):
            m.d.comb += following.eq(TestPhase.RUNNING)
        with m.Elif((phase == TestPhase.RUNNING) & ~busy):
            m.d.comb += following.eq(TestPhase.DONE)
        with m.Elif((done & anew) | granted):
            m.d.comb += following.eq(TestPhase.WANTED)
        with m.Elif((phase == TestPhase.DONE) & asked):
            m.d.comb += following.eq(TestPhase.REQUESTED)
        return m

    def _each(self, wanted: tuple[State, ...]) -> Signal:
        """Of each output, whether its state is one of these."""
        return Cat(
            Cat(self.states[output] == state for state in wanted).any()
            for output in range(len(self.states))
        )
