"""Flags: what happened is told by exactly one snapshot."""

from __future__ import annotations

from amaranth.hdl import C, Cat, Module, Mux, Signal

from railgate.odometer.proofs.contract import Observed
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

        events = dict(zip(Flag, inner["sensor_0.happened"], strict=True)) | {
            Flag.REVERSAL: self.travel.reversal,
            Flag.ILLEGAL: self.travel.illegal,
            Flag.GLITCH: C(0),
        }
        pending = Signal(len(Flag))
        pending_now = pending | Cat(events.values())
        m.d.sync += pending.eq(Mux(self.strobes.opens, 0, pending_now))
        told, carried = self.reports(m, inner, {"flags": pending_now})

        live, latches = inner["sensor_0.flags"], self.strobes.latches
        m.d.comb += [
            self.lemma.live.eq(
                Mux(latches, (live == self.at_strobe["flags"]) & (pending == 0), live == pending)
            ),
            self.lemma.carried.eq(carried),
            self.holds.eq(told),
            self.reached.eq(self.strobes.delivers & (inner["sensor.0.flags"] != 0)),
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
        method=Induction(),
        cover=READ,
        mutants=(
            _mutant(
                "strobe-wins-over-event",
                "Mux(self.latch, 0, self.flags) | happened",
                "Mux(self.latch, 0, self.flags | happened)",
                MANY_READS,
            ),
            _mutant("not-sticky", "Mux(self.latch, 0, self.flags) | happened", "happened"),
            _mutant("never-cleared", "Mux(self.latch, 0, self.flags)", "self.flags", MANY_READS),
            _mutant(
                "other-flag",
                "events[Flag.REVERSAL] = steps.reversal",
                "events[Flag.REVERSAL] = steps.illegal",
            ),
            _mutant(
                "reads-while-busy", "self.strobe & ~self.busy", "self.strobe", READ, "odometer"
            ),
        ),
    ),
)
