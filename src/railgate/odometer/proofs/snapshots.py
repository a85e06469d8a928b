"""Snapshots: all fields of all sensors are of one tick, and stay until the next ones."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Signal, Value

from railgate.odometer.proofs.contract import Strobes
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

        def watched(path: str) -> Value:
            fields = [
                inner[path.format(index, field.name)]
                for index in range(self.config.sensors)
                for field in self.config.sensor_fields
            ]
            return Cat(*fields).word_select(self.part, WATCHED)

        tick, number = Signal.like(dut.time), Signal.like(dut.number)
        at_strobe, copy = Signal.like(tick), Signal(WATCHED)
        part, begun = Signal.like(self.part), Signal()
        m.d.sync += [tick.eq(tick + 1), part.eq(self.part), begun.eq(1)]
        with m.If(strobes.opens):
            m.d.sync += [at_strobe.eq(tick), number.eq(number + 1)]
        with m.If(strobes.latches):
            m.d.sync += copy.eq(watched("sensor_{}.{}"))

        told = Cat(dut.number, dut.time, watched("sensor.{}.{}"))
        expected = Signal.like(told)
        with m.If(strobes.publishes):
            m.d.sync += expected.eq(Cat(number, at_strobe, copy))
        m.d.comb += [
            self.assumed.eq(~begun | (self.part == part)),
            self.lemma.gate.eq(strobes.agrees(inner)),
            self.lemma.taken.eq(
                strobes.latches | ~strobes.busy | (watched("latched_{}_{}") == copy)
            ),
            self.lemma.common.eq(
                (inner["gate.ticks"] == tick)
                & (~strobes.busy | (inner["gate.strobe_time"] == at_strobe))
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
            "together to what their registers were after the strobe's tick, with the time of that "
            "tick (modulo 2⁴⁸) and the number of such strobes (modulo 2³²); at all other times, "
            "also at strobes while busy, none of them changes (default configuration)."
        ),
        requirements=("ODO-7",),
        monitor=_Snapshots,
        method=Induction(),
        cover=Search(READ),
        mutants=(
            _mutant(
                "latches-late", "with m.If(gate.latch):", "with m.If(gate.busy & ~gate.publish):"
            ),
            _mutant(
                "torn-field",
                "field.name).eq(latched)",
                'field.name).eq(sensor.period if field.name == "period" else latched)',
            ),
            _mutant("tick-early", "remaining.eq(latency - 1)", "remaining.eq(latency - 2)"),
            _mutant("time-of-delivery", "self.time.eq(strobe_time)", "self.time.eq(self.ticks)"),
        ),
        fast=False,
    ),
)
