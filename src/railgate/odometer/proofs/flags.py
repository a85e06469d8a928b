"""Flags: what happened is told by exactly one snapshot."""

from __future__ import annotations

from amaranth.hdl import C, Cat, Module, Mux, Signal

from railgate.odometer.proofs.contract import LATE, Observed
from railgate.odometer.spec import Config, Flag
from railgate.proving import Claim, Induction, Mutant, Run, Search

__all__ = ["CLAIMS"]

READ = Search(24)
"""Ticks from reset within which an event can be told."""

MANY_READS = Run(5_000)
"""Random events and strobes."""


class _Flags(Observed):
    """A snapshot's flags are what happened after the strobe before, up to this strobe's tick.

    Reversals and illegal transitions are the contract's, and without a filter there is no glitch;
    the other events are those that the gateware's sensor finds.
    """

    def __init__(self) -> None:
        super().__init__(Config(), lemmas=("live", "carried"))

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.odometer(m)

        ((_, late),) = self.settled("flags")
        reversal, illegal = self.travel.reversal, self.travel.illegal
        for _ in range(late - LATE):
            earlier = reversal, illegal
            reversal, illegal = Signal(), Signal()
            m.d.sync += Cat(reversal, illegal).eq(Cat(*earlier))
        events = dict(zip(Flag, inner["sensor_0.happened"], strict=True)) | {
            Flag.REVERSAL: reversal,
            Flag.ILLEGAL: illegal,
            Flag.GLITCH: C(0),
        }
        opened, busy = self.strobes.opened, self.strobes.busy
        pending, at_strobe = Signal(len(Flag)), Signal(len(Flag))
        pending_now = pending | Cat(events.values())
        m.d.sync += pending.eq(Mux(opened[late - 1], 0, pending_now))
        with m.If(opened[late - 1]):
            m.d.sync += at_strobe.eq(pending_now)

        live, latched, out = (
            inner[path] for path in ("sensor_0.flags", "latched_0_flags", "sensor.0.flags")
        )
        told = busy | (out == at_strobe)
        m.d.comb += [
            self.lemma.live.eq(
                Mux(opened[late], (live == at_strobe) & (pending == 0), live == pending)
            ),
            self.lemma.carried.eq(told & (~opened[late + 1 : -1].any() | (latched == at_strobe))),
            self.holds.eq(told),
            self.reached.eq(self.strobes.delivers & (out != 0)),
        ]
        return m


def _mutant(
    name: str, old: str, new: str, rejected: Run | Search = READ, file: str = "sensor"
) -> Mutant:
    return Mutant(name, f"railgate.odometer.gateware.{file}", old, new, rejected)


CLAIMS = (
    Claim(
        name="odometer.flags",
        claim=(
            "Whatever the alignment of events and strobes, the flags of a snapshot are those of "
            "the events after the strobe before, up to and with this strobe's tick: each event is "
            "told by exactly one snapshot; REVERSAL and ILLEGAL are those of the pins, GLITCH "
            "never comes, the other events are taken as the sensor finds them (sensor 0; default "
            "configuration, so that filter_ticks = 0)."
        ),
        requirements=("ODO-7", "ODO-12"),
        monitor=_Flags,
        method=Induction(12),
        cover=READ,
        mutants=(
            _mutant(
                "strobe-wins-over-event",
                "Mux(self.latches[LATE + told], 0, self.flags) | happened",
                "Mux(self.latches[LATE + told], 0, self.flags | happened)",
                MANY_READS,
            ),
            _mutant("not-sticky", "Mux(self.latches[LATE + told], 0, self.flags) |", ""),
            _mutant(
                "never-cleared",
                "Mux(self.latches[LATE + told], 0, self.flags)",
                "self.flags",
                MANY_READS,
            ),
            _mutant(
                "other-flag",
                "events[Flag.REVERSAL] = steps.reversal",
                "events[Flag.REVERSAL] = steps.illegal",
            ),
            _mutant(
                "reads-while-busy", "self.strobe & ~self.busy", "self.strobe", READ, "odometer"
            ),
        ),
        fast=False,
    ),
)
