"""Upsets: whatever hardened registers are struck to, what is in no state does not drive."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from enum import IntEnum
from unittest.mock import patch

from amaranth.hdl import Cat, Fragment, Module, Signal, Value
from amaranth.lib import wiring

from railgate.proving import Claim, Induction, Internals, Monitor, Mutant
from railgate.vital_output.proofs.cut import Told
from railgate.vital_output.proofs.free import Free
from railgate.vital_output.proofs.output import DEFAULT, FLAGS
from railgate.vital_output.proofs.stimuli import mutant
from railgate.vital_output.spec import Code, Config, State, TestPhase

__all__ = ["CLAIMS"]

STRUCK_BITS = 32
"""Wider than each register that is struck."""
TWINS = ("window", "life", "image")
SHARED_STRIKES = dict.fromkeys(
    ("phase_strike", *(f"{name}{kind}_strike" for name in TWINS for kind in ("", "_inverse"))),
    STRUCK_BITS,
)
STRIKES = dict.fromkeys(("state_strike", "elapsed_strike", "inverse_strike"), STRUCK_BITS)


def _struck(block: type[wiring.Component], *strikes: Sequence[Value]) -> type[wiring.Component]:
    """The hardened register, whose registers are struck: of each that is made, in turn, and of each
    in the order in which they are assigned, the bits that are wrong in the next tick."""
    turns = iter(strikes)

    class Struck(block):
        def elaborate(self, platform: object) -> Fragment:
            fragment = Fragment.get(super().elaborate(platform), platform)
            registers, strikes = list(fragment.statements["sync"]), next(turns)
            fragment.statements["sync"] = type(fragment.statements["sync"])(
                register.lhs.eq(register.rhs ^ strike[: len(register.lhs)])
                for register, strike in zip(registers, strikes, strict=True)
            )
            return fragment

    return Struck


def _words(m: Module, states: type[IntEnum]) -> list[Value]:
    """The code of each: what a register that never leaves it holds."""
    from railgate.primitives import SparseState

    words = []
    for state in states:
        held = Internals(of_state := SparseState(states, state))
        m.submodules[f"word_{state.name.lower()}"] = held
        m.d.comb += of_state.next.eq(state)
        words.append(held["code"])
    return words


def _none(code: Value, words: Iterable[Value]) -> Value:
    return ~Cat(code == word for word in words).any()


def _differ(inner: Internals, path: str) -> Value:
    """A register's two copies are not one another's inverse."""
    return ~(inner[f"{path}.value_copy"] ^ inner[f"{path}.inverse_copy"]).all()


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
        none = _none(code, _words(m, State))
        upset = none | _differ(inner, "held_elapsed")

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


class _Shared(Free):
    """A channel, cut as vital_output.agreed, whose registers that all outputs share are struck:
    the window of the vote, life, image, the phase of the test."""

    def __init__(self) -> None:
        time = {"decides": 1, "index": 32}
        super().__init__(Config(outputs=1), 0, time | SHARED_STRIKES, ())

    def told(self) -> Told:
        time = {"index": self.index, "decides": self.decides}
        return {**super().told(), "Timekeeper": time}

    def elaborate(self, _platform: object) -> Module:
        from railgate.primitives import SparseState, Twin
        from railgate.vital_output.gateware import shutoff, storage, vote

        m = Module()
        window, life, image = (
            [getattr(self, f"{name}_strike"), getattr(self, f"{name}_inverse_strike")]
            for name in TWINS
        )
        with (
            patch.object(vote, "Twin", _struck(Twin, window)),
            patch.object(storage, "Twin", _struck(Twin, life, image)),
            patch.object(shutoff, "SparseState", _struck(SparseState, [self.phase_strike])),
        ):
            inner = self.channel(m)
        twins = ("vote.held_remaining", "storage.held_life", "storage.held_image")
        upset = (
            _none(inner["shutoff.held_phase.code"], _words(m, TestPhase))
            | Cat(_differ(inner, path) for path in twins).any()
        )

        was_upset, life_struck, image_struck = Signal(), Signal(), Signal()
        m.d.sync += [
            was_upset.eq(upset),
            life_struck.eq(Cat(life).any()),
            image_struck.eq(Cat(image).any()),
        ]
        state = inner["output_0.state"]
        m.d.comb += [
            self.holds.eq(
                ~was_upset
                | (
                    (inner["pulses"] == 0)
                    & (state != State.PRE_DRIVE)
                    & (state != State.DRIVE)
                    & (life_struck | (inner["life"] == 0))
                    & (image_struck | (inner["image"] == 0))
                )
            ),
            self.reached.eq(was_upset & ~upset),
        ]
        return m


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
    Claim(
        name="vital_output.upset-shared",
        claim=(
            "For ever and whatever comes in, whatever bits of a channel's life, image, window of "
            "the vote and phase of its test are struck, at any time and again and again: in the "
            "tick after one in which two copies differ, or the phase's code is none, the pin is 0, "
            "the output neither drives nor prepares to, and life and image are 0, unless they are "
            "struck anew (1 output, else default configuration, cut as in vital_output.agreed)."
        ),
        requirements=("DRV-16",),
        monitor=_Shared,
        fast=False,
        method=Induction(2),
        mutants=(
            mutant("life-unseen", "storage", "eq(life.error | image", "eq(image"),
            mutant("image-unseen", "storage", "eq(life.error | image.error", "eq(life.error"),
            mutant("window-unseen", "vote", "self.error.eq(remaining.error)", "self.error.eq(0)"),
            mutant("phase-unseen", "shutoff", "self.error.eq(held.error)", "self.error.eq(0)"),
            mutant(
                "drives-while-upset",
                "channel",
                "drives = ~upset & shutoff.both_done",
                "drives = shutoff.both_done",
            ),
            mutant("pulses-while-upset", "output", "& ~self.error & ~self.upset", "& ~self.error"),
        ),
    ),
)
