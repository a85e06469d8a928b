"""Bit clock and request: fixed times, for ever."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal, Value, signed

from railgate.position_link.proofs.schedule import Cycle
from railgate.position_link.proofs.stimuli import mutant
from railgate.position_link.spec import Config
from railgate.proving import Claim, Induction, Internals, Monitor, Mutant, Run, Search

__all__ = ["CLAIMS", "TWO_CYCLES", "Timed"]

CLOCKS_HZ = (40_000_000, 48_000_000, 50_000_000, 100_000_000, 125_000_000)
TENTH = 10
TWO_CYCLES = Run(1_610_000)
"""Ticks from reset that end after the second cycle's delivery, of 800 000 ticks each."""


class Timed(Monitor):
    """A link and, beside it, the ticks of its cycle."""

    def __init__(self, lemmas: tuple[str, ...]) -> None:
        super().__init__({"uef": 1, "data": 1}, ("divider", *lemmas))
        self.config = Config()

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


class _Cycles(Timed):
    """Between rises of ANF, counted at the pins: one cycle's ticks, one cycle's rises of CLK."""

    def __init__(self) -> None:
        super().__init__(("request", "counted"))

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
                (anf == now.before(config.rise(config.request_bits)))
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


class _Edges(Monitor):
    """Every edge of CLK is in the first tick that is not before its ideal instant, at all clocks.

    `late` is 2 bits · t - ticks · n after t ticks with n edges of CLK, since tick 1: an exact
    number for ever, for it stays in its bounds.
    """

    def __init__(self) -> None:
        super().__init__({}, ("divider", "counted"))

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        parts = [self._clock(m, Config(clock_hz=hz), f"at_{hz}") for hz in CLOCKS_HZ]
        for output, values in zip(
            (self.lemma.divider, self.lemma.counted, self.holds, self.reached),
            zip(*parts, strict=True),
            strict=True,
        ):
            m.d.comb += output.eq(Cat(*values).all())
        return m

    def _clock(self, m: Module, config: Config, name: str) -> tuple[Value, ...]:
        """Adds one clock's gateware: what binds it, what holds of it, and its tenth edge was."""
        from railgate.position_link.gateware.timing import Timing

        m.submodules[name] = inner = Internals(timing := Timing(config))
        m.submodules[f"{name}_now"] = now = Cycle(config)
        up, down = 2 * config.bits, config.ticks
        was, started = Signal(name=f"{name}_was"), Signal(name=f"{name}_started")
        late = Signal(signed(2 + down.bit_length()), name=f"{name}_late")
        edge = timing.clk ^ was
        m.d.sync += [
            was.eq(timing.clk),
            started.eq(1),
            late.eq(Mux(started, late + up - Mux(edge, down, 0), 0)),
        ]
        scale = down // now.stretch_ticks
        counted = Mux(
            started,
            (late == -scale * now.ahead) & (was == now.edges[0]),
            now.at(config.cycle_ticks - 1),
        )
        holds = Mux(edge, started & (late >= 0) & (late < up), ~started | (late < 0))
        return now.agrees(inner, "now"), counted, holds, now.edges >= TENTH


class _Request(Timed):
    """ANF is high from the first rise of CLK in a cycle to the eleventh, and at no other time."""

    def __init__(self) -> None:
        super().__init__(("counted",))

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
                (anf == now.before(config.rise(config.request_bits)))
                & (~begins | (rise & (now.at(0))))
                & (~ends | (rise & (width == config.request_bits)))
            ),
            self.reached.eq(ends),
        ]
        return m


def _divider(name: str, old: str, new: str, rejected: Search | Run) -> Mutant:
    return Mutant(name, "railgate.primitives.divider", old, new, rejected)


CLAIMS = (
    Claim(
        name="position_link.cycle",
        claim=(
            "For ever, from the first tick after reset on, ANF rises together with CLK exactly "
            "every 800 000 ticks, and in each such cycle CLK has exactly 10 240 rises, whatever "
            "UEF and DATA (default configuration)."
        ),
        requirements=("LNK-1", "LNK-2"),
        monitor=_Cycles,
        method=Induction(),
        cover=TWO_CYCLES,
        mutants=(
            mutant("starts-late", "timing", "init=number == 0 and first", "init=0", Search(4)),
            _divider(
                "carry-off-by-one",
                "self._numerator - self._denominator",
                "self._numerator - self._denominator - 1",
                TWO_CYCLES,
            ),
            mutant(
                "a-clk-less",
                "timing",
                "edges = 2 * config.cycle_bits",
                "edges = 2 * config.cycle_bits - 2",
                TWO_CYCLES,
            ),
        ),
        fast=False,
    ),
    Claim(
        name="position_link.jitter",
        claim=(
            "For ever, edge n of CLK since tick 1 lies in the first tick that is not before its "
            "ideal instant n · clock / (2 · 512 kHz), so less than one tick after it, and none is "
            "missing or too many: no drift adds up (40, 48, 50, 100 and 125 MHz)."
        ),
        requirements=("LNK-1",),
        monitor=_Edges,
        method=Induction(),
        cover=Run(3_000),
        mutants=(
            mutant(
                "a-tick-late",
                "timing",
                "self._delay_ticks - 2",
                "self._delay_ticks - 1",
                Run(3_000),
            ),
            _divider(
                "carry-off-by-one",
                "self._numerator - self._denominator",
                "self._numerator - self._denominator + 1",
                Run(3_000),
            ),
            _divider(
                "forgets-the-rest",
                "remainder + Mux(self.strobe, after_strobe, self._numerator)",
                "Mux(self.strobe, after_strobe, remainder + self._numerator)",
                Run(3_000),
            ),
        ),
    ),
    Claim(
        name="position_link.request",
        claim=(
            "For ever, ANF rises with the first rise of CLK of every cycle and falls with the "
            "eleventh, 10 CLK later, and is low at all other times, whatever UEF and DATA "
            "(default configuration)."
        ),
        requirements=("LNK-2",),
        monitor=_Request,
        method=Induction(),
        cover=Run(1_000),
        mutants=(
            mutant(
                "nine-clk",
                "timing",
                '"request_ends": 2 * config.request_bits',
                '"request_ends": 2 * config.request_bits - 2',
                Run(1_000),
            ),
            mutant(
                "half-a-clk-more",
                "timing",
                '"request_ends": 2 * config.request_bits',
                '"request_ends": 2 * config.request_bits + 1',
                Run(1_000),
            ),
            mutant(
                "twice",
                "timing",
                "LookaheadCounter(edges, marks)",
                "LookaheadCounter(edges // 2, marks)",
                Run(401_000),
            ),
        ),
        fast=False,
    ),
)
