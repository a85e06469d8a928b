"""Both channels together: the same images, and no false alarm."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal

from railgate.proving import Bounded, Claim, Search
from railgate.vital_output.proofs.pair import PAIR, TOLD, Pair
from railgate.vital_output.proofs.stimuli import mutant
from railgate.vital_output.spec import State

__all__ = ["CLAIMS"]

APART_TICKS = PAIR.tau0_ticks + 2 * PAIR.latency_ticks + 2
"""So far apart at least a CPU's frames are where each may come at any time of its cycle: until one
is voted in both FPGAs and each knows it of the other, and two ticks of pipeline."""
FIRST_PHASE = PAIR.tau0_ticks
"""In this phase time begins there, so that the first command's life ends early."""
LATEST_PHASE = 1 + PAIR.tau0_ticks + 1
"""Up to this phase frames may come there, so that those of two CPUs pass τ0 or do not."""
COMMANDS = 0b010
"""Image bit of each cycle: off, on, off."""
IMAGES_TICKS = 40
TRANSACTION_TICKS = 46
CLOSED = 36
"""From this tick on the contact must have been closed."""


class _Images(Pair):
    """Images differ for no longer than the skew of decisions."""

    def __init__(self) -> None:
        phases = {"first_phase": FIRST_PHASE, "last_phase": LATEST_PHASE}
        super().__init__({}, ["Output"], **phases, apart_ticks=APART_TICKS)

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        one, other = self.pair(m)
        skew = PAIR.skew_ticks
        ticks = Signal(range(skew + 2))
        differ = one["image"] != other["image"]
        m.d.sync += ticks.eq(Mux(differ, ticks + (ticks != skew + 1), 0))
        m.d.comb += [
            self.assumed.eq(Cat(self.legal).all()),
            self.holds.eq(ticks <= skew),
            self.reached.eq(ticks == PAIR.latency_ticks),
        ]
        return m


class _Transaction(Pair):
    """Off, on, off, with all in time: both drive, the contact closes, and no alarm is raised."""

    def __init__(self) -> None:
        super().__init__({})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        channels = self.pair(m)
        self.relay(m, channels)
        states = [channel["output_0.state"] for channel in channels]
        alarms = Cat(state >= State.HANDSHAKE_ALARM for state in states)
        tick, closed = Signal(range(64)), Signal()
        m.d.sync += [tick.eq(tick + 1), closed.eq(closed | self.contact)]
        m.d.comb += [
            self.assumed.eq(
                Cat(self.legal).all()
                & Cat(self.punctual).all()
                & (self.images_1 == COMMANDS)
                & (self.images_2 == COMMANDS)
            ),
            self.holds.eq(~alarms.any() & (closed | (tick < CLOSED))),
            self.reached.eq(closed & Cat(state == State.IDLE for state in states).all()),
        ]
        return m


CLAIMS = (
    Claim(
        name="vital_output.images",
        claim=(
            f"In the first {IMAGES_TICKS} ticks, from phase {FIRST_PHASE} of a cycle on, with each "
            f"CPU's frames in phases 1 … {LATEST_PHASE} of their cycles and {APART_TICKS} ticks "
            "apart at least, or missing, equal or not, inside τ0 of one another or not, and "
            "messages at most L old, the images of both FPGAs never differ for longer than the "
            f"skew of decisions, {PAIR.skew_ticks} ticks, neither by a vote nor by a life's end (1 "
            f"output, life 1 cycle, FPGA 2's time up to 2 ticks behind FPGA 1's; {TOLD})."
        ),
        requirements=("DRV-6", "DRV-7", "DRV-14"),
        monitor=_Images,
        method=Bounded(IMAGES_TICKS, "two channels; a stored command's whole life is in it"),
        cover=Search(25),
        mutants=(
            mutant("stored-by-one", "vote", "                & self.peer_passed\n", "", Search(25)),
            mutant(
                "image-of-the-own-cpu",
                "vote",
                "same = self.own.as_value() == forwarded.as_value()",
                "same = self.own.sequence == forwarded.sequence",
                Search(20),
            ),
        ),
        fast=False,
    ),
    Claim(
        name="vital_output.transaction",
        claim=(
            f"In the first {TRANSACTION_TICKS} ticks, with the frames of off, on, off in phases 1 "
            "… 2 of their cycles and messages at most L old, no alarm is raised in either FPGA, "
            f"both drive, and the contact is closed by tick {CLOSED}, whatever the lines' latency, "
            "the frames' ticks and the clocks (1 output, FPGA 2's time up to 2 ticks behind FPGA "
            f"1's; {TOLD})."
        ),
        requirements=("DRV-6", "DRV-9", "DRV-10", "DRV-14"),
        monitor=_Transaction,
        method=Bounded(TRANSACTION_TICKS, "two channels; a transaction ends in it, idle again"),
        cover=Search(TRANSACTION_TICKS),
        mutants=(
            mutant(
                "no-patience",
                "output",
                "elapsed >= config.not_yet_driving_ticks",
                "elapsed >= 1",
                Search(32),
            ),
            mutant(
                "tau1-too-short",
                "output",
                "elapsed >= config.tau1_ticks - 1",
                "elapsed >= config.latency_ticks",
                Search(32),
            ),
        ),
        fast=False,
    ),
)
