"""What the contract finds on the line in a cycle, beside the gateware's reader and verdict."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.position_link.proofs.pins import Level
from railgate.position_link.proofs.schedule import Cycle
from railgate.position_link.spec import Cause, Config, Edge

__all__ = ["Reading"]


class Reading(wiring.Component):
    """The events of a cycle in the order of the contract, each of one tick.

    uef, data: in, 1 bit, the pins. The other members, out, are registers.
    seen, answered, under_way, complete: 1 bit, of this cycle so far. bits: of the answer, word:
    those read last, field: their check so far, since: ticks since UEF's pin rose for it, to this
    one. causes: since the last decision. found, was_complete, good, read: causes, whether it was
    complete and good, and word, of the last decision, from the tick after it on.
    """

    def __init__(self, config: Config) -> None:
        self.config = config
        self.cycle = Cycle(config, config.input_delay_ticks)
        self.on_uef, self.on_data = Level(config.filter_ticks), Level(config.filter_ticks)
        # Bit n: n + 1 ticks ago there was an edge of DATA, and a bit was taken; two bits more than
        # the contract asks for.
        self.edges = Signal(max(config.guard_ticks - 1, 0) + 2)
        self.taken = Signal(config.guard_ticks + 2)
        self.decision = config.decision_ticks - config.input_delay_ticks
        flags = ("seen", "answered", "under_way", "complete", "was_complete", "good")
        super().__init__(
            {"uef": In(1), "data": In(1)}
            | {name: Out(1) for name in flags}
            | {name: Out(len(Cause)) for name in ("causes", "found")}
            | {name: Out(config.word_bits) for name in ("word", "read")}
            | {"bits": Out(range(config.word_bits + 1)), "since": Out(config.age_ticks_bits)}
            | (
                {"field": Out(config.check.width, init=config.check.initial)}
                if config.check
                else {}
            )
        )

    def after_decision(self, ticks: int) -> Value:
        """It is so many ticks after the decision's."""
        return self.cycle.at(self.decision + ticks)

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config, cycle, uef = self.config, self.cycle, self.on_uef
        m.submodules.cycle, m.submodules.on_uef, m.submodules.on_data = cycle, uef, self.on_data
        m.d.comb += [uef.pin.eq(self.uef), self.on_data.pin.eq(self.data)]
        happens = dict.fromkeys(Cause, 0)

        starts, closes = cycle.at(0), cycle.at(config.rise(config.window_bits))
        opened = ~cycle.before(config.rise(config.earliest_clk - 1))
        closed = ~cycle.before(config.rise(config.window_bits))
        happens[Cause.STUCK] = starts & uef.level & ~uef.rise
        seen, answered, complete = (
            value & ~starts for value in (self.seen, self.answered, self.complete)
        )
        happens[Cause.TIMEOUT] = closes & ~seen

        begins = uef.rise & opened & ~closed & ~answered
        happens[Cause.EARLY] = uef.rise & ~opened
        happens[Cause.UNREQUESTED] = uef.rise & opened & ~begins
        under_way, bits = self.under_way | begins, Mux(begins, 0, self.bits)

        full = bits == config.word_bits
        ends = under_way & uef.fall
        complete |= ends & full
        happens[Cause.SHORT] = ends & ~full
        under_way &= ~uef.fall

        rising = config.sampling_edge is Edge.RISING
        samples = under_way & cycle.edge & (cycle.edges[0] ^ rising)
        happens[Cause.LONG] = samples & full
        takes = samples & ~full
        word = Mux(takes, Cat(self.on_data.level, self.word), self.word)
        edge = self.on_data.rise | self.on_data.fall
        m.d.sync += [
            self.edges.eq(Cat(edge, self.edges)),
            self.taken.eq(Cat(takes, self.taken)),
        ]
        if config.guard_ticks:
            moved = edge | self.edges[:-2].any()
            happens[Cause.UNSTABLE] = (takes & moved) | (edge & self.taken[:-2].any())

        for cause, found in self._of_word(m, begins, takes, word).items():
            happens[cause] = complete & found
        causes = Cat(happens.values()) | self.causes
        decides = self.after_decision(0)
        m.d.sync += [
            self.seen.eq(seen | uef.level),
            self.answered.eq(answered | begins),
            self.under_way.eq(under_way & ~happens[Cause.LONG]),
            self.bits.eq(bits + takes),
            self.since.eq(Mux(begins, config.input_delay_ticks, self.since) + 1),
            self.word.eq(word),
            self.complete.eq(complete),
            self.causes.eq(Mux(decides, 0, causes)),
        ]
        with m.If(decides):
            m.d.sync += [
                self.found.eq(causes),
                self.was_complete.eq(complete),
                self.good.eq(complete & (causes == 0)),
                self.read.eq(word),
            ]
        return m

    def _of_word(self, m: Module, begins: Value, takes: Value, word: Value) -> dict[Cause, Value]:
        """What is wrong with a word in the tick of the decision, 0 in others."""
        config, decides = self.config, self.after_decision(0)
        found = {Cause.CHECK: 0, Cause.FAULT_WORD: decides & (word == config.invalid_word)}
        found[Cause.ZERO_WORD] = decides & (word == 0) & config.zero_is_fault
        if check := config.check:
            before = Mux(begins, check.initial, self.field)
            adds = before[-1] ^ self.on_data.level
            after = (before << 1)[: check.width] ^ Mux(adds, check.polynomial, 0)
            checked = begins | (self.bits < config.word_bits - check.width)
            m.d.sync += self.field.eq(Mux(takes & checked, after, before))
            found[Cause.CHECK] = decides & (word[: check.width] != self.field ^ check.final)
        return found
