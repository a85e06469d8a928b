"""Two FPGAs' outputs, each beside the other: none drives alone for long, and how it ends stays."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from amaranth.hdl import (
    Cat,
    ClockDomain,
    DomainRenamer,
    EnableInserter,
    Module,
    Mux,
    ResetSignal,
    Signal,
    Value,
)

from railgate.proving import Bounded, Claim, Induction, Monitor, Mutant, Search
from railgate.vital_output.proofs.output import among
from railgate.vital_output.proofs.pair import PAIR, STEADY_TICKS, TIMING, TOLD, Clock, Line
from railgate.vital_output.proofs.stimuli import mutant
from railgate.vital_output.spec import Code, State

if TYPE_CHECKING:
    from railgate.vital_output.gateware.output import Output

__all__ = ["CLAIMS"]

FREE = ("cmd", "fb", "frequency", "contact", "acknowledged")
PINS = {f"{name}_{n}": 1 for n in (1, 2) for name in FREE}
SILENT = PAIR.latency_ticks + 2
"""So long at most an output drives beside a peer that has left, and two ticks of pipeline."""
ALONE = PAIR.not_yet_driving_ticks + 2
"""So long at most it drives beside a peer that does not drive."""
HALVES = 2
"""Ticks of a monitor for one of a clock, where each of its edges has one."""
REST = (State.IDLE, State.WAIT, State.HANDSHAKE_ALARM, State.FEEDBACK_ALARM)


class _Outputs(Monitor):
    """Two outputs whose commands and feedback are free, with clocks of their own and lines."""

    def __init__(self, lemmas: Iterable[str] = (), domains: Iterable[str] = ()) -> None:
        super().__init__({**TIMING, **PINS}, lemmas, domains)

    def outputs(self, m: Module, latency_ticks: int) -> tuple[list[Output], list[Line], Value]:
        """Adds them, and lines; whether clocks are steady and messages in time."""
        from railgate.vital_output.gateware.output import Output

        outputs = [Output(PAIR) for _ in range(2)]
        lines = [Line(len(Code), latency_ticks) for _ in range(2)]
        legal = []
        for n, (output, own, peers) in enumerate(zip(outputs, lines, lines[::-1], strict=True), 1):
            m.submodules[f"clock_{n}"] = clock = Clock()
            m.submodules[f"line_{n}"] = own
            told: dict[str, Value] = {name: getattr(self, f"{name}_{n}") for name in FREE}
            told["peer_code"] = peers.told
            m.d.comb += [
                own.delivers.eq(getattr(self, f"delivers_{n}")),
                own.sent.eq(output.code),
                clock.run.eq(self.clock(m, n, output, told)),
            ]
            legal += [clock.steady, own.in_time]
        return outputs, lines, Cat(legal).all()

    def clock(self, m: Module, n: int, output: Output, told: Mapping[str, Value]) -> Value:
        """Adds the output, with its inputs; it has an edge in each tick with run."""
        run = getattr(self, f"run_{n}")
        m.submodules[f"fpga_{n}"] = EnableInserter(run)(output)
        m.d.comb += [getattr(output, name).eq(value) for name, value in told.items()]
        return run


class _Alone(_Outputs):
    """How long each drives without the other."""

    ticks_each = 1
    """Of the monitor for one of a clock."""

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        outputs, _, legal = self.outputs(m, self.latency())
        longest, within = [], []
        for one, other in (outputs, outputs[::-1]):
            drives = one.state == State.DRIVE
            left = (other.code == Code.OFF) | (other.code == Code.ALARM)
            for limit, apart in ((SILENT, left), (ALONE, other.state != State.DRIVE)):
                most = self.ticks_each * limit
                ticks = Signal(range(most + 2))
                m.d.sync += ticks.eq(Mux(drives & apart, ticks + (ticks != most + 1), 0))
                within.append(ticks <= most)
                longest.append(ticks > most - self.ticks_each)
        m.d.comb += [
            self.assumed.eq(legal),
            self.holds.eq(Cat(within).all()),
            self.reached.eq(Cat(longest[1::2]).any()),
        ]
        return m

    def latency(self) -> int:
        """Of a line at most, in ticks of the monitor."""
        return PAIR.latency_ticks


class _TwoClocks(_Alone):
    """The same with two clocks: in each tick of the monitor with run_n FPGA n's clock rises or
    falls, and its registers are in a domain of that clock. Its inputs do not change with a rising
    edge: so they come up to two ticks of the monitor later, by which the line is faster.
    """

    ticks_each = HALVES

    def __init__(self) -> None:
        super().__init__(domains=("fpga_1", "fpga_2"))

    def latency(self) -> int:
        return HALVES * (PAIR.latency_ticks - 1)

    def outputs(self, m: Module, latency_ticks: int) -> tuple[list[Output], list[Line], Value]:
        outputs, lines, legal = super().outputs(m, latency_ticks)
        return outputs, lines, legal & ~ResetSignal()

    def clock(self, m: Module, n: int, output: Output, told: Mapping[str, Value]) -> Value:
        run, level = getattr(self, f"run_{n}"), Signal(name=f"level_{n}")
        domain = ClockDomain(f"fpga_{n}", local=True, reset_less=True)
        m.domains += domain
        m.submodules[f"fpga_{n}"] = DomainRenamer(f"fpga_{n}")(output)
        m.d.comb += domain.clk.eq(level)
        m.d.sync += level.eq(level ^ run)
        with m.If(~run | level):
            m.d.sync += [getattr(output, name).eq(value) for name, value in told.items()]
        return run


class _Ends(_Outputs):
    """What both are in stays while nothing else is commanded, whatever their clocks and lines do:
    `off`, none drives or prepares to; `on`, both drive, and tell it one another."""

    def __init__(self) -> None:
        super().__init__(("sound",))

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        outputs, lines, _ = self.outputs(m, PAIR.latency_ticks)
        both = {name: Cat(getattr(self, f"{name}_{n}") for n in (1, 2)) for name in FREE}
        rests = Cat(among(output.state, REST) for output in outputs).all()
        told = [code for line in lines for code in (line.carried, line.told)]
        agreed = Cat(
            *(output.state == State.DRIVE for output in outputs),
            *(code == Code.DRIVE for code in told),
        ).all()
        good = both["cmd"].all() & both["frequency"].all() & both["contact"].all()
        off, on = Signal(), Signal()
        m.d.sync += [off.eq(rests & ~both["cmd"].any()), on.eq(agreed & good)]
        m.d.comb += [
            self.lemma.sound.eq(~Cat(output.error for output in outputs).any()),
            self.holds.eq((~off | rests) & (~on | agreed)),
            self.reached.eq(on),
        ]
        return m


def _mutants(ticks: int) -> tuple[Mutant, ...]:
    """Each is found so many ticks of the monitor from reset at the latest."""
    return tuple(
        mutant(name, "output", old, new, Search(ticks))
        for name, old, new in (
            (
                "drives-on",
                "with m.Elif(self.peer_code == Code.OFF):",
                "with m.Elif((self.peer_code == Code.OFF) & self.fb):",
            ),
            (
                "alarm-ignored",
                "with m.Elif(self.peer_code == Code.ALARM):",
                "with m.Elif((self.peer_code == Code.ALARM) & self.fb):",
            ),
            (
                "tolerates-for-long",
                "elapsed >= config.not_yet_driving_ticks",
                "elapsed >= config.pick_up_ticks",
            ),
        )
    )


TICKS = 48
ALONE_CLAIM = (
    "whatever the commands and the feedback of two FPGAs' outputs, with messages at most L old, "
    f"one drives for at most L + 2 = {SILENT} ticks beside a peer that is idle, waits or is in an "
    f"alarm, and for at most 2L + δ + 2 = {ALONE} beside one that does not drive"
)

CLAIMS = (
    Claim(
        name="vital_output.alone",
        claim=f"In the first {TICKS} ticks, {ALONE_CLAIM} ({TOLD}).",
        requirements=("DRV-10", "DRV-14"),
        monitor=_Alone,
        method=Bounded(TICKS, "what two clocks and two lines have agreed on is no short invariant"),
        cover=Search(25),
        mutants=_mutants(25),
        fast=False,
    ),
    Claim(
        name="vital_output.alone-clocked",
        claim=(
            f"In the first {TICKS} ticks, {ALONE_CLAIM}; as vital_output.alone, but each FPGA's "
            "registers are in a domain of its own clock, whose edges, two a tick, are free in a "
            f"global clock's steps, each half a tick, of which it loses one in {STEADY_TICKS} at "
            f"most: clocks as enables lose nothing ({TOLD})."
        ),
        requirements=("DRV-10", "DRV-14"),
        monitor=_TwoClocks,
        method=Bounded(HALVES * TICKS, "as vital_output.alone"),
        cover=Search(HALVES * 25),
        mutants=_mutants(HALVES * 25),
        fast=False,
    ),
    Claim(
        name="vital_output.ends",
        claim=(
            "For ever, once two FPGAs' outputs are both idle, waiting or in an alarm, they stay so "
            "while neither has a command; and once both drive and their lines tell so both ways, "
            "they do while both have the command and a good feedback; whatever else comes in, at "
            "any clocks and any latency of the lines (configuration as in vital_output.alone)."
        ),
        requirements=("DRV-8", "DRV-10", "DRV-14"),
        monitor=_Ends,
        method=Induction(),
        cover=Search(20),
        mutants=(
            mutant(
                "drives-with-the-peer",
                "output",
                "with m.Elif(self.cmd):\n                    "
                "m.d.comb += following.eq(State.PRE_DRIVE)",
                "with m.Elif(self.cmd | peer_in_drive):\n                    "
                "m.d.comb += following.eq(State.PRE_DRIVE)",
            ),
            mutant(
                "not-yet-for-ever",
                "output",
                "peer_in_pre_drive & (elapsed >=",
                "(elapsed >=",
            ),
            mutant(
                "contact-ignored",
                "output",
                "(elapsed >= config.pick_up_ticks) & ~self.contact",
                "elapsed >= config.pick_up_ticks",
                Search(25),
            ),
        ),
    ),
)
