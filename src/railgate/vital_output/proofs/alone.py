"""One output of both channels: neither drives alone for long."""

from __future__ import annotations

from amaranth.hdl import Cat, EnableInserter, Module, Mux, Signal

from railgate.proving import Bounded, Claim, Monitor, Search
from railgate.vital_output.proofs.pair import CLOCKS, LINKS, PAIR, Clock, Line
from railgate.vital_output.proofs.stimuli import mutant
from railgate.vital_output.spec import Code, State

__all__ = ["CLAIMS"]

FREE = ("cmd", "fb", "frequency", "contact", "acknowledged")
L = PAIR.latency_ticks
SILENT, ALONE = L + 2, PAIR.not_yet_driving_ticks + 2


class _Alone(Monitor):
    def __init__(self) -> None:
        own = {f"{name}_{n}": 1 for name in FREE for n in (1, 2)}
        super().__init__({**CLOCKS, **LINKS, **own})

    def elaborate(self, _platform: object) -> Module:
        from railgate.vital_output.gateware.output import Output

        m = Module()
        outputs, steady = [], []
        for n in (1, 2):
            m.submodules[f"clock_{n}"] = clock = Clock()
            m.d.comb += clock.run.eq(getattr(self, f"run_{n}"))
            output = Output(PAIR)
            m.submodules[f"fpga_{n}"] = EnableInserter(clock.run)(output)
            m.d.comb += [getattr(output, name).eq(getattr(self, f"{name}_{n}")) for name in FREE]
            outputs.append(output)
            steady.append(clock.steady)
        for n, (sender, receiver) in enumerate((outputs, outputs[::-1]), 1):
            m.submodules[f"line_{n}"] = line = Line(2, L)
            m.d.comb += [
                line.sent.eq(sender.code),
                line.sends.eq(getattr(self, f"sends_{n}")),
                line.delivers.eq(getattr(self, f"delivers_{n}")),
                receiver.peer_code.eq(line.told),
            ]
            steady.append(line.in_time)
        bounded, longest = [], []
        for one, other in (outputs, outputs[::-1]):
            drives = one.state == State.DRIVE
            silent = (other.code == Code.OFF) | (other.code == Code.ALARM)
            for most, apart in ((SILENT, silent), (ALONE, other.state != State.DRIVE)):
                ticks = Signal(range(most + 2))
                m.d.sync += ticks.eq(Mux(drives & apart, ticks + (ticks != most + 1), 0))
                bounded.append(ticks <= most)
                longest.append(ticks == most)
        m.d.comb += [
            self.assumed.eq(Cat(steady).all()),
            self.holds.eq(Cat(bounded).all()),
            self.reached.eq(longest[1]),
        ]
        return m


CLAIMS = (
    Claim(
        name="vital_output.alone",
        claim="x.",
        requirements=("DRV-10", "DRV-14"),
        monitor=_Alone,
        method=Bounded(30, "x"),
        cover=Search(25),
        mutants=(mutant("a", "output", "a", "b"), mutant("b", "output", "a", "b")),
    ),
)
