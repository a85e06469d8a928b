"""Both channels together: the same images, no output alone for long, no false alarm."""

from __future__ import annotations

from amaranth.hdl import Cat, EnableInserter, Module, Mux, Signal

from railgate.proving import Bounded, Claim, Monitor, Search
from railgate.vital_output.proofs.pair import PAIR, TIMING, TOLD, Clock, Line, Pair
from railgate.vital_output.proofs.stimuli import mutant
from railgate.vital_output.spec import Code, State

__all__ = ["CLAIMS"]

FREE = ("cmd", "fb", "frequency", "contact", "acknowledged")
SILENT = PAIR.latency_ticks + 2
"""So long at most an output drives beside a peer that has left, and two ticks of pipeline."""
ALONE = PAIR.not_yet_driving_ticks + 2
"""So long at most it drives beside a peer that does not drive."""
COMMANDS = 0b010
"""Image bit of each cycle: off, on, off."""
CLOSED = 38
"""From this tick on the contact must have been closed."""


class _Alone(Monitor):
    """Two outputs, whose commands and feedback are free; how long each drives without the other."""

    def __init__(self) -> None:
        super().__init__({**TIMING, **{f"{name}_{n}": 1 for n in (1, 2) for name in FREE}})

    def elaborate(self, _platform: object) -> Module:
        from railgate.vital_output.gateware.output import Output

        m = Module()
        lines = [Line(len(Code), PAIR.latency_ticks) for _ in range(2)]
        outputs = [Output(PAIR) for _ in range(2)]
        legal, longest, within = [], [], []
        for n, (output, own, peers) in enumerate(zip(outputs, lines, lines[::-1], strict=True), 1):
            m.submodules[f"clock_{n}"] = clock = Clock()
            m.submodules[f"line_{n}"] = own
            m.submodules[f"fpga_{n}"] = EnableInserter(clock.run)(output)
            m.d.comb += [
                clock.run.eq(getattr(self, f"run_{n}")),
                own.delivers.eq(getattr(self, f"delivers_{n}")),
                own.sent.eq(output.code),
                output.peer_code.eq(peers.told),
                *(getattr(output, name).eq(getattr(self, f"{name}_{n}")) for name in FREE),
            ]
            legal += [clock.steady, own.in_time]
        for one, other in (outputs, outputs[::-1]):
            drives = one.state == State.DRIVE
            left = (other.code == Code.OFF) | (other.code == Code.ALARM)
            for most, apart in ((SILENT, left), (ALONE, other.state != State.DRIVE)):
                ticks = Signal(range(most + 2))
                m.d.sync += ticks.eq(Mux(drives & apart, ticks + (ticks != most + 1), 0))
                within.append(ticks <= most)
                longest.append(ticks == most)
        m.d.comb += [
            self.assumed.eq(Cat(legal).all()),
            self.holds.eq(Cat(within).all()),
            self.reached.eq(longest[1]),
        ]
        return m


class _Images(Pair):
    """Images differ for no longer than the skew of decisions."""

    def __init__(self) -> None:
        super().__init__({}, ["Output"])

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
        name="vital_output.alone",
        claim=(
            "In the first 36 ticks, whatever the commands and the feedback of two FPGAs' outputs, "
            f"with messages at most L old, one drives for at most L + 2 = {SILENT} ticks beside a "
            f"peer that is idle, waits or is in an alarm, and for at most 2L + δ + 2 = {ALONE} "
            f"beside one that does not drive ({TOLD})."
        ),
        requirements=("DRV-10", "DRV-14"),
        monitor=_Alone,
        method=Bounded(36, "what two clocks and two lines have agreed on is no short invariant"),
        cover=Search(25),
        mutants=(
            mutant(
                "drives-on",
                "output",
                "with m.Elif(self.peer_code == Code.OFF):",
                "with m.Elif((self.peer_code == Code.OFF) & self.fb):",
                Search(20),
            ),
            mutant(
                "alarm-ignored",
                "output",
                "with m.Elif(self.peer_code == Code.ALARM):",
                "with m.Elif((self.peer_code == Code.ALARM) & self.fb):",
                Search(20),
            ),
            mutant(
                "tolerates-for-long",
                "output",
                "elapsed >= config.not_yet_driving_ticks",
                "elapsed >= config.pick_up_ticks",
                Search(25),
            ),
        ),
        fast=False,
    ),
    Claim(
        name="vital_output.images",
        claim=(
            "In the first 46 ticks, with each CPU's frames in their cycles' first ticks, or "
            "missing, equal or not, and messages at most L old, the images of both FPGAs never "
            f"differ for longer than the skew of decisions, {PAIR.skew_ticks} ticks, neither by a "
            f"vote nor by a life's end (1 output, life 1 cycle; {TOLD})."
        ),
        requirements=("DRV-6", "DRV-7", "DRV-14"),
        monitor=_Images,
        method=Bounded(46, "two channels; the first life's end is in it"),
        cover=Search(25),
        mutants=(
            mutant("stored-by-one", "vote", "                & self.peer_passed\n", "", Search(30)),
            mutant(
                "open-for-ever",
                "vote",
                "self.stored | (self.decides & (ahead <= 0))",
                "self.stored",
                Search(46),
            ),
        ),
        fast=False,
    ),
    Claim(
        name="vital_output.transaction",
        claim=(
            "In the first 50 ticks, with the frames of off, on, off in the first ticks of their "
            "cycles and messages at most L old, no alarm is raised in either FPGA, both drive, and "
            f"the contact is closed by tick {CLOSED}, whatever the lines' latency, the frames' "
            f"ticks and the clocks (1 output; {TOLD})."
        ),
        requirements=("DRV-6", "DRV-9", "DRV-10", "DRV-14"),
        monitor=_Transaction,
        method=Bounded(50, "two channels; a transaction ends in it, idle again"),
        cover=Search(50),
        mutants=(
            mutant(
                "no-patience",
                "output",
                "elapsed >= config.not_yet_driving_ticks",
                "elapsed >= 1",
                Search(40),
            ),
            mutant(
                "leaves-without-skew",
                "output",
                "elapsed >= config.skew_ticks",
                "elapsed >= 1",
                Search(50),
            ),
        ),
        fast=False,
    ),
)
