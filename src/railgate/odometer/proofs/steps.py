"""Steps: position, direction and levels agree."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal, Value, signed

from railgate.odometer.proofs.contract import SEATED, Observed, counts, quarter
from railgate.odometer.spec import Config
from railgate.proving import Claim, Induction, Internals, Mutant, Search

__all__ = ["CLAIMS"]

READ = 26
"""Ticks from reset within which a few steps can be made and told."""


class _Counted(Observed):
    """What the contract counts of the steps.

    After `counted`: position, direction_changes, illegal_transitions by name, each before and
    after this tick's events.
    """

    def counted(self, m: Module, inner: Internals) -> dict[str, tuple[Value, Value]]:
        """Adds it; gives the fields, and drives the lemma `counts`."""
        width, travel = self.config.count_bits, self.travel
        position = Signal(signed(width))
        changes, illegal = Signal(width), Signal(width)
        fields = {
            "position": (position, position + travel.forward - travel.back),
            "direction_changes": (changes, changes + travel.reversal),
            "illegal_transitions": (illegal, illegal + travel.illegal),
        }
        m.d.sync += [register.eq(now) for register, now in fields.values()]
        m.d.comb += self.lemma.counts.eq(
            counts(inner, "sensor_0.direction_changes")
            & counts(inner, "sensor_0.illegal_transitions")
        )
        return fields


class _Steps(_Counted):
    """Each snapshot tells the steps of the pins' levels, by the quarters that these are in."""

    def __init__(self) -> None:
        super().__init__(Config(), lemmas=("counts", "carried"))

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.odometer(m)
        direction = (self.travel.direction, self.travel.next)
        told, carried = self.reports(m, inner, self.counted(m, inner) | {"direction": direction})
        m.d.comb += [
            self.lemma.carried.eq(carried),
            self.holds.eq(told),
            self.reached.eq(
                self.strobes.delivers
                & (inner["sensor.0.direction_changes"] == 1)
                & (inner["sensor.0.illegal_transitions"] == 1)
            ),
        ]
        return m


class _Agreement(_Counted):
    """Position and levels of each snapshot tell the same quarter, of which illegal steps skip two.

    So told by the ports alone, but for the quarter at start.
    """

    def __init__(self) -> None:
        super().__init__(Config(), lemmas=("counts", "live", "copies", "carried"))

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.odometer(m)
        strobes, a, b = self.strobes, self.on_a, self.on_b

        start, seated = Signal(2), Signal()
        begins, goes_on = a.age(SEATED), a.age(SEATED + 1)
        with m.If(begins & ~goes_on):
            m.d.sync += start.eq(quarter(a.level, b.level))
        with m.If(strobes.opens):
            m.d.sync += seated.eq(begins)

        def agrees(fields: dict[str, Value], seated: Value) -> Value:
            position, illegal, a, b = (fields[name] for name in names)
            same = (quarter(a, b) - position - 2 * illegal)[:2] == start
            return Mux(seated, same, Cat(position, illegal, a, b) == 0)

        fields = self.counted(m, inner)
        del fields["direction_changes"]
        fields |= {"level_a": (a.before, a.level), "level_b": (b.before, b.level)}
        names = tuple(fields)
        told, carried = self.reports(m, inner, fields)
        m.d.comb += [
            self.lemma.live.eq(agrees({name: fields[name][0] for name in names}, goes_on)),
            self.lemma.copies.eq(agrees(self.at_strobe, seated) & (~seated | goes_on)),
            self.lemma.carried.eq(carried & told),
            self.holds.eq(
                strobes.busy | agrees({name: inner[f"sensor.0.{name}"] for name in names}, seated)
            ),
            self.reached.eq(
                strobes.delivers & (inner["sensor.0.position"] == -2) & seated & (start == 1)
            ),
        ]
        return m


def _mutant(name: str, old: str, new: str, file: str = "sensor") -> Mutant:
    return Mutant(name, f"railgate.odometer.gateware.{file}", old, new, Search(READ))


CLAIMS = (
    Claim(
        name="odometer.steps",
        claim=(
            "Position, direction, direction changes and illegal transitions of each snapshot are "
            "those of the pins' levels up to the strobe's tick: a quarter forward is + 1 and "
            "FORWARD, a quarter back is - 1 and REVERSE, two at once are illegal and NONE, a step "
            "against the direction is a change of it (sensor 0; default configuration, modulo 2³²)."
        ),
        requirements=("ODO-5", "ODO-6"),
        monitor=_Steps,
        method=Induction(8),
        cover=Search(READ),
        mutants=(
            _mutant(
                "wrong-sign",
                "Cat(forward | reverse, reverse)",
                "Cat(forward | reverse, forward)",
                "steps",
            ),
            _mutant(
                "other-edge",
                "self.a ^ self.b ^ self.b_edge",
                "self.a ^ self.b ^ self.a_edge",
                "steps",
            ),
            _mutant(
                "illegal-steps",
                "step = self.a_edge ^ self.b_edge",
                "step = self.a_edge | self.b_edge",
                "steps",
            ),
            _mutant(
                "keeps-direction",
                "heading.eq(Direction.NONE)",
                "heading.eq(heading)",
                "steps",
            ),
            _mutant(
                "latches-late",
                "with m.If(gate.latches[late]):",
                "with m.If(gate.latches[late:LAST].any()):",
                "odometer",
            ),
        ),
        fast=False,
    ),
    Claim(
        name="odometer.quarters",
        claim=(
            "In each snapshot of a strobe from tick 3 on, position + 2 · illegal_transitions is, "
            "modulo 4, how many quarters forward of the levels at start level_a and level_b are; "
            "before, all of them are 0 (sensor 0; default configuration)."
        ),
        requirements=("ODO-5", "ODO-6", "ODO-7"),
        monitor=_Agreement,
        method=Induction(8),
        cover=Search(READ),
        mutants=(
            _mutant(
                "level-tick-late", "self.level_a.eq(a_level)", "self.level_a.eq(a_level & ~a_rise)"
            ),
            _mutant(
                "rises-only",
                "Cat(a.rise, a.rise | a.fall, a.level",
                "Cat(a.rise, a.rise, a.level",
            ),
            _mutant(
                "illegal-untold",
                "self.illegal_transitions, steps.illegal",
                "self.illegal_transitions, 0",
            ),
            Mutant(
                "edge-at-start",
                "railgate.primitives.inputs",
                "passes & synchronised & ~seats[-1]",
                "passes & synchronised",
                Search(READ),
            ),
        ),
        fast=False,
    ),
)
