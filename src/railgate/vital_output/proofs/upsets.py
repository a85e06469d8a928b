"""Upsets: whatever an output's registers are struck to, what is no state does not drive."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any
from unittest.mock import patch

from amaranth.hdl import Cat, Fragment, Module, Signal, Value
from amaranth.lib import wiring

from railgate.proving import Claim, Induction, Internals, Monitor, Mutant
from railgate.vital_output.proofs.output import DEFAULT, FLAGS
from railgate.vital_output.proofs.stimuli import mutant
from railgate.vital_output.spec import Code, State

__all__ = ["CLAIMS"]

STRUCK_BITS = 32
"""Wider than each register that is struck."""
STRIKES = dict.fromkeys(("state_strike", "elapsed_strike", "inverse_strike"), STRUCK_BITS)


def _struck(block: type[wiring.Component], strikes: Iterable[Value]) -> type[wiring.Component]:
    """The hardened register, whose registers are struck: for each, in the order in which they are
    assigned, the bits that are wrong in the next tick."""

    class Struck(block):
        def elaborate(self, platform: object) -> Fragment:
            fragment = Fragment.get(super().elaborate(platform), platform)
            registers = list(fragment.statements["sync"])
            fragment.statements["sync"] = type(fragment.statements["sync"])(
                register.lhs.eq(register.rhs ^ strike[: len(register.lhs)])
                for register, strike in zip(registers, strikes, strict=True)
            )
            return fragment

    return Struck


class _Upset(Monitor):
    """An output whose inputs are free, and whose hardened registers are struck at any time.

    state_strike, elapsed_strike, inverse_strike: in, the bits of the state's code, and of both
    copies of `elapsed`, that are wrong in the next tick.
    """

    def __init__(self) -> None:
        super().__init__({"peer_code": 2} | dict.fromkeys(FLAGS, 1) | STRIKES)

    def elaborate(self, _platform: object) -> Module:
        from railgate.primitives import SparseState, Twin
        from railgate.vital_output.gateware import output

        m = Module()
        registers = {
            "SparseState": _struck(SparseState, [self.state_strike]),
            "Twin": _struck(Twin, [self.elapsed_strike, self.inverse_strike]),
        }
        with patch.multiple(output, **registers):  # type: ignore[call-overload]
            inner = Internals(dut := output.Output(DEFAULT))
        m.submodules.dut = inner
        for name in (*FLAGS, "peer_code"):
            m.d.comb += getattr(dut, name).eq(getattr(self, name))

        code = inner["held_state.code"]
        none = ~Cat(code == word for word in self._words(m, SparseState)).any()
        copies = Cat(inner["held_elapsed.value_copy"] ^ inner["held_elapsed.inverse_copy"])
        upset = none | ~copies.all()

        strike = self.state_strike[: len(code)]
        few = sum(strike[bit] for bit in range(len(code)))
        near, struck, was_upset, pulsed = Signal(), Signal(), Signal(), Signal()
        m.d.sync += [
            near.eq((few == 1) | (few == 2)),
            struck.eq(strike.any()),
            was_upset.eq(upset),
            pulsed.eq(~none & ((dut.state == State.DRIVE) | (dut.state == State.TEST))),
        ]
        m.d.comb += [
            self.holds.eq(
                (~near | none)
                & (dut.error == upset)
                & (~none | ((dut.state == State.FEEDBACK_ALARM) & (dut.code == Code.ALARM)))
                & (~was_upset | struck | (dut.state == State.FEEDBACK_ALARM))
                & ~(dut.pulse & (was_upset | ~pulsed))
            ),
            self.reached.eq(was_upset & ~struck & ~upset),
        ]
        return m

    def _words(self, m: Module, register: Any) -> list[Value]:
        """The code of each state: what a register that never leaves it holds."""
        words = []
        for state in State:
            held = Internals(of_state := register(State, state))
            m.submodules[f"word_{state.name.lower()}"] = held
            m.d.comb += of_state.next.eq(state)
            words.append(held["code"])
        return words


CLAIMS = (
    Claim(
        name="vital_output.upset",
        claim=(
            "For ever and whatever comes in, whatever bits of an output's state and of its times "
            "are struck, at any time and again and again: a code of the state that is none, which "
            "each is that differs from a state's in one or two bits, tells the peer an alarm and "
            "drives nothing, neither do two copies of a time that differ, and in the next tick "
            "the pin is 0 and the state FEEDBACK_ALARM, unless it is struck anew (default "
            "configuration)."
        ),
        requirements=("DRV-8", "DRV-16"),
        monitor=_Upset,
        method=Induction(2),
        mutants=(
            Mutant(
                "words-too-near", "railgate.primitives.hardened", "DISTANCE = 3", "DISTANCE = 2"
            ),
            mutant(
                "stays-after-an-upset",
                "output",
                "self.error):\n            m.d.comb += following.eq(State.FEEDBACK_ALARM)",
                "self.error):\n            m.d.comb += following.eq(State.IDLE)",
            ),
            mutant(
                "tells-the-peer-off",
                "output",
                "self.state.eq(Mux(state.error, State.FEEDBACK_ALARM, state.value))",
                "self.state.eq(state.value)",
            ),
            mutant("pulses-while-upset", "output", "& ~self.error & ~self.upset", "& ~self.upset"),
            mutant("times-unseen", "output", "state.error | elapsed.error", "state.error"),
        ),
    ),
)
