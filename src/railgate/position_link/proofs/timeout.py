"""Timeout: exactly 30 CLK."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal

from railgate.position_link.proofs.schedule import Cycle
from railgate.position_link.proofs.stimuli import GOOD, NOTHING, WORD, Answer, mutant, run
from railgate.position_link.proofs.supervised import Supervised
from railgate.position_link.spec import Cause, Config
from railgate.proving import Claim, Induction

__all__ = ["CLAIMS"]

UNFILTERED = Config(filter_ticks=0)


class _Timeout(Supervised):
    """TIMEOUT is told of a cycle if and only if the pin was 0 in each tick of its first 30 CLK.

    Where filter_ticks = 0, u[k] is the pin of tick k - 3 and nothing but a delay.
    """

    def __init__(self) -> None:
        super().__init__(UNFILTERED, ("level", "window", "quiet"))

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        inner, reading = self.link(m), self.reading
        config = self.config
        delay = config.input_delay_ticks
        m.submodules.now = now = Cycle(config)
        window = config.rise(config.timeout_bits)

        high, published = Signal(), Signal()
        m.d.sync += high.eq((high & ~now.at(0)) | (self.uef & now.before(window)))
        with m.If(now.at(config.delivery_ticks - 1)):
            m.d.sync += published.eq(~high)

        seated = [
            (reading.on_uef.tick != tick) | now.at((tick - 1) % config.cycle_ticks)
            for tick in range(delay)
        ]
        past, seen = reading.on_uef.past[:delay], reading.seen
        expected = seen | past.any()
        for ticks in range(1, delay + 1):
            expected = Mux(now.at(ticks), past[:ticks].any(), expected)
            expected = Mux(now.at(window + ticks), seen | (past >> ticks).any(), expected)
        early = (reading.causes & Cause.TIMEOUT).any()
        decided = ~reading.cycle.before(reading.decision + 1)
        found = (Mux(decided, reading.found, reading.causes) & Cause.TIMEOUT).any()
        told = (inner["causes"] & Cause.TIMEOUT).any()
        m.d.comb += [
            self.lemma.level.eq(reading.cycle.follows(now, delay) & Cat(*seated).all()),
            self.lemma.window.eq(
                Mux(
                    now.before(window + delay + 1),
                    (now.at(0) | (high == expected)) & ~early,
                    ~now.before(config.delivery_ticks) | (found == ~high),
                )
            ),
            self.lemma.quiet.eq(~decided | ~early),
            self.holds.eq(told == published),
            self.reached.eq(inner["delivery"] & told),
        ]
        return m


CLAIMS = (
    Claim(
        name="position_link.timeout",
        claim=(
            "For ever, a cycle has the cause TIMEOUT if and only if UEF's pin is 0 in each of the "
            "2344 ticks from the rise of ANF to the rise of the 31st CLK, exactly 30 CLK later "
            "(default configuration, but filter_ticks = 0, so that the pin is seen as it is)."
        ),
        requirements=("LNK-4",),
        monitor=_Timeout,
        method=Induction(),
        cover=run(UNFILTERED, NOTHING),
        mutants=(
            mutant(
                "a-clk-late",
                "timing",
                '"closes": 2 * config.window_bits',
                '"closes": 2 * config.window_bits + 2',
                run(UNFILTERED, [Answer(WORD, clk=31, late_ticks=0)]),
            ),
            mutant(
                "a-clk-early",
                "timing",
                '"closes": 2 * config.window_bits',
                '"closes": 2 * config.window_bits - 2',
                run(UNFILTERED, [Answer(WORD, clk=31, late_ticks=-1)]),
            ),
            mutant(
                "a-tick-late",
                "reader",
                "self.closes & ~seen",
                "self.closes & ~(seen | self.uef)",
                run(UNFILTERED, [Answer(WORD, clk=31, late_ticks=0)]),
            ),
            mutant(
                "from-the-end-of-anf",
                "timing",
                '"closes": 2 * config.window_bits',
                '"closes": 2 * (config.window_bits + config.request_bits)',
                run(UNFILTERED, [Answer(WORD, clk=36)]),
            ),
            mutant(
                "seen-once-seen-always",
                "reader",
                "(seen & ~self.starts)",
                "seen",
                run(UNFILTERED, [GOOD], NOTHING),
            ),
        ),
        fast=False,
    ),
)
