"""Bit clock, request and delivery: fixed times, for ever."""

from __future__ import annotations

from functools import partial

from amaranth.hdl import Cat, Module, Mux, Signal, signed

from railgate.position_link.proofs.observed import schedule
from railgate.position_link.proofs.schedule import Cycle
from railgate.position_link.spec import Config
from railgate.proving import Claim, Induction, Internals, Monitor, Mutant, Run, Search

__all__ = ["CLAIMS"]


class _Timed(Monitor):
    """A link and, beside it, the ticks of its cycle."""

    def __init__(self, clock_hz: int, lemmas: tuple[str, ...]) -> None:
        super().__init__({"uef": 1, "data": 1}, ("divider", *lemmas))
        self.config = Config(clock_hz=clock_hz)

    def link(self, m: Module) -> tuple[Internals, Cycle]:
        """Adds both, and what binds the bit clock's accumulator to the ticks."""
        from railgate.position_link.gateware import PositionLink

        m.submodules.dut = inner = Internals(dut := PositionLink(self.config))
        m.submodules.now = now = Cycle(self.config)
        m.d.comb += [
            dut.uef.eq(self.uef),
            dut.data.eq(self.data),
            self.lemma.divider.eq(now.agrees(inner, "timing.now")),
        ]
        return inner, now


class _Cycles(_Timed):
    """Between rises of ANF, counted at the pins: one cycle's ticks, one cycle's rises of CLK."""

    def __init__(self, clock_hz: int) -> None:
        super().__init__(clock_hz, ("request", "counted"))

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner, now = self.link(m)
        config = self.config
        clk, anf = inner["clk"], inner["anf"]

        was_clk, was_anf, started = Signal(), Signal(), Signal()
        ticks = Signal(range(config.cycle_ticks + 2))  # since ANF rose, with this one
        rises = Signal(range(config.cycle_bits + 2))
        rise, request = clk & ~was_clk, anf & ~was_anf
        m.d.sync += [
            was_clk.eq(clk),
            was_anf.eq(anf),
            started.eq(1),
            ticks.eq(Mux(request, 1, ticks + 1)),
            rises.eq(Mux(request, 0, rises) + rise),
        ]
        first = Signal(init=1)
        with m.If(request):
            m.d.sync += first.eq(0)
        exact = (ticks == config.cycle_ticks) & (rises == config.cycle_bits)
        due = Mux(first, started, exact)
        m.d.comb += [
            self.lemma.request.eq(
                (anf == (now.before(config.rise(config.request_bits))))
                & (was_anf == (~now.at(0) & now.before(config.rise(config.request_bits) + 1)))
                & (was_clk == now.edges[0])
            ),
            self.lemma.counted.eq(
                Mux(
                    first,
                    Mux(started, now.at(0), now.at(config.cycle_ticks - 1)),
                    started
                    & Mux(
                        now.at(0),
                        exact,
                        (ticks == now.tick) & (rises == (now.edges + 1) >> 1),
                    ),
                )
            ),
            self.holds.eq((request == due) & (~request | rise)),
            self.reached.eq(request & ~first),
        ]
        return m


class _Edges(_Timed):
    """Every edge of CLK is in the first tick that is not before its ideal instant.

    `late` is 2 bits · t - ticks · n after t ticks with n edges at the pin, since tick 1: an exact
    number for ever, for it stays in its bounds.
    """

    def __init__(self, clock_hz: int) -> None:
        super().__init__(clock_hz, ("counted",))

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner, now = self.link(m)
        up, down = 2 * self.config.bits, self.config.ticks
        clk, was, started = inner["clk"], Signal(), Signal()
        edge = clk ^ was
        late = Signal(signed(2 + down.bit_length()))
        m.d.sync += [
            was.eq(clk),
            started.eq(1),
            late.eq(Mux(started, late + up - Mux(edge, down, 0), 0)),
        ]
        scale = down // now.stretch_ticks
        m.d.comb += [
            self.lemma.counted.eq(
                Mux(
                    started,
                    (late == -scale * now.ahead) & (was == now.edges[0]),
                    now.at(self.config.cycle_ticks - 1),
                )
            ),
            self.holds.eq(Mux(edge, started & (late >= 0) & (late < up), ~started | (late < 0))),
            self.reached.eq(edge & (now.edges == 2)),
        ]
        return m


class _Request(_Timed):
    """ANF is high from the first rise of CLK in a cycle to the eleventh, and at no other time."""

    def __init__(self, clock_hz: int) -> None:
        super().__init__(clock_hz, ("counted",))

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner, now = self.link(m)
        config = self.config
        clk, anf = inner["clk"], inner["anf"]

        was_clk, was_anf = Signal(), Signal()
        rise = clk & ~was_clk
        begins, ends = anf & ~was_anf, ~anf & was_anf
        width = Signal(range(config.request_bits + 2))  # rises of CLK with ANF high
        m.d.sync += [was_clk.eq(clk), was_anf.eq(anf)]
        with m.If(anf & rise):
            m.d.sync += width.eq(Mux(begins, 1, width + 1))
        bits = (now.edges + 1) >> 1
        m.d.comb += [
            self.lemma.counted.eq(
                (was_anf == (~now.at(0) & now.before(config.rise(config.request_bits) + 1)))
                & (was_clk == now.edges[0])
                & (~was_anf | (width == bits))
            ),
            self.holds.eq(
                (anf == (now.before(config.rise(config.request_bits))))
                & (~begins | (rise & (now.at(0))))
                & (~ends | (rise & (width == config.request_bits)))
            ),
            self.reached.eq(ends),
        ]
        return m




class _Delivery(_Timed):
    """One tick of `delivery` a cycle, delivery_ticks after the rise of ANF; no field changes else."""

    def __init__(self, clock_hz: int) -> None:
        super().__init__(clock_hz, ("late", "schedule", "counted"))

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner, now = self.link(m)
        config = self.config
        m.submodules.late = late = Cycle(config, config.input_delay_ticks)
        delivery, deliveries = inner["delivery"], Signal(config.count_bits)
        deliveries_now = (deliveries + delivery)[: config.count_bits]
        stay, started = [], Signal()
        for field in config.fields:
            value = inner[field.name]
            past = Signal(field.width, name=f"past_{field.name}", init=field.start)
            m.d.sync += past.eq(value)
            stay.append(value == past)
        m.d.sync += [deliveries.eq(deliveries_now), started.eq(1)]
        m.d.comb += [
            self.lemma.late.eq(late.agrees(inner, "timing.delayed") & late.follows(now, config.input_delay_ticks)),
            self.lemma.schedule.eq(schedule(inner, config, late)),
            self.lemma.counted.eq(inner["number"] == deliveries_now),
            self.holds.eq(
                (delivery == now.at(config.delivery_ticks))
                & (delivery | Cat(*stay).all())
                & (inner["number"] == deliveries_now)
            ),
            self.reached.eq(delivery & (deliveries == 1)),
        ]
        return m


CLAIMS = (
    Claim(
        name="position_link.cycle",
        claim="x",
        requirements=("LNK-1",),
        monitor=partial(_Cycles, 40_000_000),
        method=Induction(),
        cover=Run(900_000),
        mutants=(
            Mutant(
                "a", "railgate.primitives.divider", "remainder >= 0", "remainder > 0", Search(20)
            ),
            Mutant("b", "railgate.position_link.gateware.timing", "if starts", "if", Search(20)),
        ),
    ),
    Claim(
        name="position_link.jitter",
        claim="x",
        requirements=("LNK-1",),
        monitor=partial(_Edges, 40_000_000),
        method=Induction(),
        cover=Search(90),
        mutants=(
            Mutant(
                "a", "railgate.primitives.divider", "remainder >= 0", "remainder > 0", Search(100)
            ),
            Mutant(
                "b",
                "railgate.primitives.divider",
                "- self._denominator\n",
                "- self._denominator - 1\n",
                Search(200),
            ),
        ),
    ),
    Claim(
        name="position_link.request",
        claim="x",
        requirements=("LNK-1",),
        monitor=partial(_Request, 40_000_000),
        method=Induction(),
        cover=Run(800),
        mutants=(
            Mutant(
                "a", "railgate.primitives.divider", "remainder >= 0", "remainder > 0", Search(20)
            ),
            Mutant("b", "railgate.position_link.gateware.timing", "if starts", "if", Search(20)),
        ),
    ),
    Claim(
        name="position_link.delivery",
        claim="x",
        requirements=("LNK-6",),
        monitor=partial(_Delivery, 40_000_000),
        method=Induction(),
        cover=Run(820_000),
        mutants=(
            Mutant("a", "railgate.primitives.divider", "remainder >= 0", "remainder > 0", Search(20)),
            Mutant("b", "railgate.position_link.gateware.timing", "if starts", "if", Search(20)),
        ),
    ),
)
