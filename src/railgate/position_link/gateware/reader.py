"""The answer: its word, and what is wrong with it while it comes."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.position_link.spec import Cause, Config
from railgate.primitives import OneShot, SerialCheck

__all__ = ["LINE_CAUSES", "Reader"]

LINE_CAUSES = (
    Cause.TIMEOUT,
    Cause.EARLY,
    Cause.SHORT,
    Cause.LONG,
    Cause.STUCK,
    Cause.UNREQUESTED,
    Cause.UNSTABLE,
)
"""What shows on the line, the others in the word."""


class Reader(wiring.Component):
    """Reads one answer a cycle, and tells the causes that show on the line.

    uef, uef_rise, uef_fall, data, data_edge: in, 1 bit, filtered levels and their edges. starts,
    early, open, closes, sample, decided: in, 1 bit, see Timing.
    causes: out, registers, a bit for each of LINE_CAUSES, since the last decision, three ticks
    late. complete: out, 1 bit, register, the answer of this cycle was. word: out, register, the
    bits of the last answer, the last one read is the least significant. check: out, what the word's
    check must be, only where it has one. since_rise: out, register, ticks since UEF's pin rose for
    the last answer, counted to the second tick after this one. Requirements LNK-3, LNK-4, LNK-7.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        inputs = ("uef", "uef_rise", "uef_fall", "data", "data_edge")
        times = ("starts", "early", "open", "closes", "sample", "decided")
        super().__init__(
            {name: In(1) for name in (*inputs, *times)}
            | {
                "causes": Out(len(LINE_CAUSES)),
                "complete": Out(1),
                "word": Out(config.word_bits),
                "since_rise": Out(range(config.delivery_ticks + 1)),
            }
            | ({"check": Out(config.check.width)} if config.check else {})
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config = self._config
        events = dict.fromkeys(LINE_CAUSES, 0)

        seen = Signal()
        answered = Signal()
        begins = Signal()
        m.d.comb += begins.eq(self.uef_rise & self.open & (self.starts | ~answered))
        m.d.sync += [
            seen.eq(self.uef | (seen & ~self.starts)),
            answered.eq(begins | (answered & ~self.starts)),
        ]
        events[Cause.STUCK] = self.starts & self.uef & ~self.uef_rise
        events[Cause.TIMEOUT] = self.closes & ~seen
        events[Cause.EARLY] = self.uef_rise & self.early
        events[Cause.UNREQUESTED] = self.uef_rise & ~self.early & ~begins
        for cause in (Cause.STUCK, Cause.TIMEOUT, Cause.EARLY, Cause.UNREQUESTED):
            events[cause] = _later(m, events[cause], f"found_{cause.name}".lower())

        # A tick later: the answer under way, one that lacks bits and one that has them all.
        begun = _later(m, begins, "begun")
        ends = _later(m, self.uef_fall, "ends")
        samples = _later(m, self.sample, "samples")
        data = _later(m, self.data, "data_then")
        lacking = Signal()
        whole = Signal()
        last = Signal()  # one bit is lacking
        goes_on = begun | (lacking & ~ends)
        takes = Signal()
        filled = samples & lacking & ~ends & last
        m.d.comb += takes.eq(samples & goes_on)
        m.d.sync += [
            lacking.eq(goes_on & ~filled),
            whole.eq(filled | (whole & ~ends & ~samples)),
            self.complete.eq((whole & ends) | (self.complete & ~self.starts)),
        ]
        events[Cause.SHORT] = lacking & ends
        events[Cause.LONG] = whole & samples & ~ends
        happened = _later(m, Cat(events.values()), "happened")
        at_rise = config.input_delay_ticks + 4
        since_rise = Signal.like(self.since_rise, init=at_rise, reset_less=True)
        m.d.comb += self.since_rise.eq(since_rise)
        m.d.sync += since_rise.eq(Mux(begun, at_rise, since_rise + 1))

        # Two ticks later: the bits taken, and how still DATA held around them.
        taken = _later(m, takes, "taken")
        bit = _later(m, data, "bit")
        moved = _later(m, _later(m, self.data_edge, "moves"), "moved")
        unstable = Signal(len(LINE_CAUSES))
        if config.guard_ticks:
            m.submodules.holding = holding = OneShot(config.guard_ticks)
            m.d.comb += holding.trigger.eq(taken)
            found = moved & (taken | holding.active)
            if config.guard_ticks > 1:
                m.submodules.settling = settling = OneShot(config.guard_ticks - 1)
                m.d.comb += settling.trigger.eq(moved)
                found |= taken & settling.active
            m.d.comb += unstable[LINE_CAUSES.index(Cause.UNSTABLE)].eq(found)
        m.d.sync += self.causes.eq(Mux(self.decided, 0, self.causes) | happened | unstable)

        bits = Signal(range(config.word_bits + 1))
        with m.If(taken):
            m.d.sync += [
                self.word.eq(Cat(bit, self.word)),
                bits.eq(bits + 1),
                last.eq(bits == config.word_bits - 2),
            ]
        with m.If(self.starts):
            m.d.sync += [bits.eq(0), last.eq(0)]

        if config.check:
            check = SerialCheck(
                config.check.width,
                config.check.polynomial,
                config.check.initial,
                config.check.final,
            )
            m.submodules.check = check
            covered = Signal(init=1)  # the bit taken is one of those that the check is made of
            with m.If(taken):
                m.d.sync += covered.eq(bits < config.word_bits - config.check.width - 1)
            with m.If(self.starts):
                m.d.sync += covered.eq(1)
            m.d.comb += [
                check.restart.eq(self.starts),
                check.enable.eq(taken & covered),
                check.bit.eq(bit),
                self.check.eq(check.field),
            ]
        return m


def _later(m: Module, value: Value, name: str) -> Signal:
    """A register: what it was a tick ago."""
    later = Signal.like(value, name=name)
    m.d.sync += later.eq(value)
    return later
