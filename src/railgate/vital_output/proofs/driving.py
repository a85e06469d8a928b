"""One output: how it comes to drive, and how it gets out of an alarm."""

from __future__ import annotations

from functools import partial

from amaranth.hdl import Module, Signal

from railgate.proving import Claim, Induction, Mutant
from railgate.vital_output.proofs.output import ALARMS, DEFAULT, PULSING, Watched, among
from railgate.vital_output.proofs.stimuli import mutant
from railgate.vital_output.spec import Code, State

__all__ = ["CLAIMS"]


class _Drive(Watched):
    """DRIVE is entered from PRE_DRIVE alone, which the peer's factor ends inside τ1; pulses are
    made in DRIVE and TEST alone, from the tick after the first one on."""

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.output(m)
        state, before = inner["state"], self.before
        agreed, pulses = Signal(), Signal()
        factor = (self.peer_code == Code.PRE_DRIVE) | (self.peer_code == Code.DRIVE)
        m.d.sync += [
            agreed.eq(factor & self.cmd & ~self.fb & (self.elapsed < self.config.tau1_ticks)),
            pulses.eq(self.starts_high & ~self.upset),
        ]
        enters = (state == State.DRIVE) & (before != State.DRIVE)
        m.d.comb += [
            self.holds.eq(
                (~enters | ((before == State.PRE_DRIVE) & agreed))
                & ((state != State.PRE_DRIVE) | (self.elapsed < self.config.tau1_ticks))
                & (inner["pulse"] == (among(before, PULSING) & pulses))
            ),
            self.reached.eq(enters),
        ]
        return m


class _Alarms(Watched):
    """An alarm is left for IDLE alone, and only as DRV-12 has it."""

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.output(m)
        state, before = inner["state"], self.before
        at_rest, acknowledged = Signal(), Signal()
        m.d.sync += [at_rest.eq(~self.cmd & ~self.fb), acknowledged.eq(self.acknowledged)]
        handshake, feedback = (before == alarm for alarm in ALARMS)
        left = (handshake | feedback) & (state != before)
        m.d.comb += [
            self.holds.eq(~left | ((state == State.IDLE) & at_rest & (handshake | acknowledged))),
            self.reached.eq(left & feedback),
        ]
        return m


def _mutant(name: str, old: str, new: str) -> Mutant:
    return mutant(name, "output", old, new)


CLAIMS = (
    Claim(
        name="vital_output.output-drive",
        claim=(
            "For ever, an output enters DRIVE from PRE_DRIVE alone, with its command 1, nothing "
            "fed back, and the peer's factor inside the first τ1 ticks of PRE_DRIVE, which never "
            "lasts longer; its pin pulses in the ticks after those of DRIVE and TEST and in no "
            "other, never while something is upset (default configuration)."
        ),
        requirements=("DRV-9", "DRV-10"),
        monitor=partial(_Drive, DEFAULT),
        method=Induction(),
        mutants=(
            _mutant("alarm-will-do", "peer_in_pre_drive | peer_in_drive", "self.peer_code != 0"),
            _mutant(
                "from-idle",
                "with m.Elif(self.cmd):\n                    "
                "m.d.comb += following.eq(State.PRE_DRIVE)",
                "with m.Elif(self.cmd):\n                    m.d.comb += following.eq(State.DRIVE)",
            ),
            _mutant("pulses-while-upset", "& ~self.error & ~self.upset", "& ~self.error"),
        ),
    ),
    Claim(
        name="vital_output.output-alarms",
        claim=(
            "For ever, an output leaves an alarm for IDLE alone, with its command 0 and nothing "
            "fed back, and FEEDBACK_ALARM only in the tick in which it is acknowledged, whatever "
            "else comes in (default configuration)."
        ),
        requirements=("DRV-12",),
        monitor=partial(_Alarms, DEFAULT),
        method=Induction(),
        mutants=(
            _mutant("command-stays", "m.If(~self.cmd & ~self.fb)", "m.If(~self.fb)"),
            _mutant(
                "contact-stays",
                "m.If(self.acknowledged & ~self.cmd & ~self.fb)",
                "m.If(self.acknowledged & ~self.cmd)",
            ),
            _mutant(
                "not-latched",
                "m.If(self.acknowledged & ~self.cmd & ~self.fb)",
                "m.If(~self.cmd & ~self.fb)",
            ),
        ),
    ),
)
