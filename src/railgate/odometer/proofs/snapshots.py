"""Snapshots: all fields of all sensors are of one tick, and stay until the next ones."""

from __future__ import annotations

from amaranth.hdl import Cat, Const, Module, Signal, Value

from railgate.odometer.proofs.contract import Strobes, counts
from railgate.odometer.spec import Config
from railgate.proving import Claim, Induction, Internals, Monitor, Mutant, Search

__all__ = ["CLAIMS"]

READ = 20
"""Ticks from reset within which a snapshot can be told."""

WATCHED = 128
"""Bits of all fields that are compared at once: the fewer, the faster the proof."""


class _Snapshots(Monitor):
    """All that the odometer tells is a copy of the sensors' registers after one strobe's tick.

    Of all the fields, laid end to end, WATCHED bits are compared: those of the input `part`, which
    may be any but stays the same, so that what is proven holds of every part.
    """

    def __init__(self) -> None:
        self.config = Config()
        bits = self.config.sensors * sum(field.width for field in self.config.sensor_fields)
        pins = {f"{pin}{index}": 1 for pin in "ab" for index in range(self.config.sensors)}
        super().__init__(
            {"strobe": 1, **pins, "part": range(-(-bits // WATCHED))},
            lemmas=("gate", "taken", "common"),
        )

    def elaborate(self, _platform: object) -> Module:
        from railgate.odometer.gateware import Odometer
        from railgate.odometer.gateware.sensor import settled

        m = Module()
        dut = Odometer(self.config)
        m.submodules.dut = inner = Internals(dut)
        m.submodules.strobes = strobes = Strobes()
        m.d.comb += [dut.strobe.eq(self.strobe), strobes.strobe.eq(self.strobe)]
        for index, pins in enumerate(dut.sensor):
            m.d.comb += [
                pins.a.eq(getattr(self, f"a{index}")),
                pins.b.eq(getattr(self, f"b{index}")),
            ]

        fields = [
            (index, field)
            for index in range(self.config.sensors)
            for field in self.config.sensor_fields
        ]

        def watched(path: str) -> Value:
            found = (inner[path.format(index, field.name)] for index, field in fields)
            return Cat(*found).word_select(self.part, WATCHED)

        masks = [0] * Config.snapshot_latency_ticks  # of the bits that are so late
        at = 0
        for _, field in fields:
            for part, late in settled(self.config, field):
                masks[late] |= ((1 << part.stop - part.start) - 1) << at
                at += part.stop - part.start
        so_late = [Const(mask, at).word_select(self.part, WATCHED) for mask in masks]

        tick, number = Signal.like(dut.time), Signal.like(dut.number)
        at_strobe, copy, copy_now = Signal.like(tick), Signal(WATCHED), Signal(WATCHED)
        part, begun = Signal.like(self.part), Signal()
        opened = strobes.opened
        takes = Signal(WATCHED)
        taken = [(copy & ~Const((1 << at) - 1, at).word_select(self.part, WATCHED)) == 0]
        for ticks, bits in enumerate(so_late[:-1]):
            with m.If(opened[ticks]):
                m.d.comb += takes.eq(bits)
            same = ((watched("latched_{}_{}") ^ copy) & bits) == 0
            taken.append(~opened[ticks + 1 : -1].any() | same)
        m.d.comb += copy_now.eq((copy & ~takes) | (watched("sensor_{}.{}") & takes))
        m.d.sync += [tick.eq(tick + 1), part.eq(self.part), begun.eq(1), copy.eq(copy_now)]
        with m.If(strobes.opens):
            m.d.sync += [at_strobe.eq(tick), number.eq(number + 1)]

        told = Cat(dut.number, dut.time, watched("sensor.{}.{}"))
        expected = Signal.like(told)
        with m.If(strobes.publishes):
            m.d.sync += expected.eq(Cat(number, at_strobe, copy_now))
        m.d.comb += [
            self.assumed.eq(~begun | (self.part == part)),
            self.lemma.gate.eq(strobes.agrees(inner)),
            self.lemma.taken.eq(Cat(*taken).all()),
            self.lemma.common.eq(
                counts(inner, "gate.ticks")
                & counts(inner, "gate.next_number")
                & ((inner["gate.ticks"] + begun)[: len(tick)] == tick)
                & (begun == inner["gate.started_0"])
                & (begun | ~strobes.busy)
                & (~opened[1:-1].any() | (inner["gate.next_time"] == at_strobe))
                & (~opened[0] | ((at_strobe + 1)[: len(tick)] == tick))
                & ((inner["gate.next_number"] + opened[0])[: len(number)] == number)
                & ((dut.number + strobes.busy)[: len(number)] == number)
            ),
            self.holds.eq((told == expected) & (dut.busy == strobes.busy)),
            self.reached.eq(strobes.delivers & (dut.number == 1) & told[-WATCHED:].any()),
        ]
        return m


def _mutant(name: str, old: str, new: str) -> Mutant:
    return Mutant(name, "railgate.odometer.gateware.odometer", old, new, Search(READ))


CLAIMS = (
    Claim(
        name="odometer.snapshot",
        claim=(
            "16 ticks after a strobe that found busy = 0, all fields of both sensors change "
            "together to what their registers tell of the strobe's tick, each part as late as its "
            "register is, with the time of that tick (modulo 2⁴⁸) and the number of such strobes "
            "(modulo 2³²); at all other times, also at strobes while busy, none of them changes "
            "(default configuration)."
        ),
        requirements=("ODO-7",),
        monitor=_Snapshots,
        method=Induction(),
        cover=Search(READ),
        mutants=(
            _mutant(
                "latches-late",
                "with m.If(gate.latches[late]):",
                "with m.If(gate.latches[late:LAST].any()):",
            ),
            _mutant(
                "torn-field",
                "if late == LAST else",
                'if late == LAST or field.name == "period" else',
            ),
            _mutant("tick-early", "If(gate.latches[LAST])", "If(gate.latches[LAST - 1])"),
            _mutant("time-of-delivery", "self.time.eq(next_time)", "self.time.eq(self.ticks)"),
        ),
        fast=False,
    ),
)
