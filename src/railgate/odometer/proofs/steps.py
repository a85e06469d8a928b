"""Steps: position, direction and levels agree."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal, Value, signed

from railgate.odometer.proofs.contract import SEATED, Observed, quarter
from railgate.odometer.spec import Config
from railgate.proving import Claim, Induction, Mutant, Search

__all__ = ["CLAIMS"]

READ = 26
"""Ticks from reset within which a few steps can be made and told."""


class _Steps(Observed):
    """Each snapshot tells the steps of the pins' levels, by the quarters that these are in."""

    def __init__(self) -> None:
        super().__init__(Config(), lemmas=("live", "carried"))

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.odometer(m)
        width = self.config.count_bits

        travel = self.travel
        position = Signal(signed(width))
        changes, illegal = Signal(width), Signal(width)
        registers = {
            "position": (position, position + travel.forward - travel.back),
            "direction_changes": (changes, changes + travel.reversal),
            "illegal_transitions": (illegal, illegal + travel.illegal),
        }
        m.d.sync += [register.eq(now) for register, now in registers.values()]
        fields = {name: now for name, (_, now) in registers.items()}
        told, carried = self.reports(m, inner, {**fields, "direction": travel.next})
        live = [inner[f"sensor_0.{name}"] == register for name, (register, _) in registers.items()]
        m.d.comb += [
            self.lemma.live.eq(Cat(*live).all()),
            self.lemma.carried.eq(carried),
            self.holds.eq(told),
            self.reached.eq(
                self.strobes.delivers
                & (inner["sensor.0.direction_changes"] == 1)
                & (inner["sensor.0.illegal_transitions"] == 1)
            ),
        ]
        return m


class _Agreement(Observed):
    """Position and levels of each snapshot tell the same quarter, of which illegal steps skip two.

    So told by the ports alone, but for the quarter at start.
    """

    def __init__(self) -> None:
        super().__init__(Config(), lemmas=("levels", "live", "carried"))

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner = self.odometer(m)
        strobes = self.strobes

        tick, start, seated = Signal(range(SEATED + 2)), Signal(2), Signal()
        m.d.sync += tick.eq(Mux(tick > SEATED, tick, tick + 1))
        with m.If(tick == SEATED):
            m.d.sync += start.eq(quarter(self.on_a.level, self.on_b.level))
        with m.If(strobes.opens):
            m.d.sync += seated.eq(tick >= SEATED)

        def agrees(where: str, seated: Value) -> Value:
            names = ("position", "illegal_transitions", "level_a", "level_b")
            position, illegal, a, b = (inner[where.format(name)] for name in names)
            same = (quarter(a, b) - position - 2 * illegal)[:2] == start
            return Mux(seated, same, Cat(position, illegal, a, b) == 0)

        told = agrees("sensor.0.{}", seated)
        under_way = Mux(
            strobes.latches, agrees("sensor_0.{}", seated), agrees("latched_0_{}", seated)
        )
        levels = [
            inner[f"sensor_0.level_{c}"] == channel.before
            for c, channel in (("a", self.on_a), ("b", self.on_b))
        ]
        m.d.comb += [
            self.lemma.levels.eq(Cat(*levels, tick == self.on_a.ticks).all()),
            self.lemma.live.eq(agrees("sensor_0.{}", tick > SEATED)),
            self.lemma.carried.eq(Mux(strobes.busy, under_way, told) & (~seated | (tick > SEATED))),
            self.holds.eq(strobes.busy | told),
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
        method=Induction(),
        cover=Search(READ),
        mutants=(
            _mutant(
                "wrong-sign", "+ steps.forward - steps.reverse", "- steps.forward + steps.reverse"
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
                "self.direction.eq(Direction.NONE)",
                "self.direction.eq(self.direction)",
                "steps",
            ),
            _mutant(
                "latches-late",
                "with m.If(gate.latch):",
                "with m.If(gate.busy & ~gate.publish):",
                "odometer",
            ),
        ),
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
        method=Induction(),
        cover=Search(READ),
        mutants=(
            _mutant(
                "level-tick-late", "self.level_a.eq(a.level)", "self.level_a.eq(a.level & ~a.rise)"
            ),
            _mutant(
                "rises-only",
                "a_edge, b_edge = a.rise | a.fall, b.rise | b.fall",
                "a_edge, b_edge = a.rise, b.rise",
            ),
            _mutant(
                "illegal-untold",
                "self.illegal_transitions + steps.illegal",
                "self.illegal_transitions",
            ),
            Mutant(
                "edge-at-start",
                "railgate.primitives.inputs",
                "passes & synchronised & ~seats[-1]",
                "passes & synchronised",
                Search(READ),
            ),
        ),
    ),
)
