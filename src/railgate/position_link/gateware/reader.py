"""The answer: its word, and what is wrong with it while it comes."""

from __future__ import annotations

from enum import IntEnum

from amaranth.hdl import Cat, Module, Mux, Signal
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


class Answer(IntEnum):
    """How far the answer of a cycle has come; FAILED is one that was too short or too long."""

    NONE = 0
    UNDER_WAY = 1
    COMPLETE = 2
    FAILED = 3


class Reader(wiring.Component):
    """Reads one answer a cycle, and tells the causes that show on the line.

    uef, uef_rise, uef_fall, data, data_edge: in, 1 bit, filtered levels and their edges. starts,
    early, open, closes, sample, decided: in, 1 bit, see Timing.
    causes: out, registers, a bit for each of LINE_CAUSES, since the last decision. complete: out,
    1 bit, the answer of this cycle was. word: out, register, the bits of the last answer, the last
    one read is the least significant. check: out, what the word's check must be, only where it
    has one. since_rise: out, register, ticks since UEF's pin rose for the last answer, counted to
    the tick after this one. Requirements LNK-3, LNK-4, LNK-7.
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
        m.d.sync += seen.eq(self.uef | (seen & ~self.starts))
        events[Cause.STUCK] = self.starts & self.uef & ~self.uef_rise
        events[Cause.TIMEOUT] = self.closes & ~seen

        answer = Signal(Answer)
        bits = Signal(range(config.word_bits + 1))
        full = bits == config.word_bits

        begins = Signal()
        ends = Signal()
        takes = Signal()
        too_long = Signal()
        first = self.starts | (answer == Answer.NONE)
        reads = self.sample & (begins | ((answer == Answer.UNDER_WAY) & ~self.uef_fall))
        m.d.comb += [
            begins.eq(self.uef_rise & self.open & first),
            ends.eq(self.uef_fall & (answer == Answer.UNDER_WAY)),
            takes.eq(reads & (begins | ~full)),
            too_long.eq(reads & ~begins & full),
        ]
        events[Cause.EARLY] = self.uef_rise & self.early
        events[Cause.UNREQUESTED] = self.uef_rise & ~self.early & ~begins
        events[Cause.SHORT] = ends & ~full
        events[Cause.LONG] = too_long

        with m.If(self.starts):
            m.d.sync += answer.eq(Answer.NONE)
        with m.If(begins):
            m.d.sync += answer.eq(Answer.UNDER_WAY)
        with m.Elif(ends):
            m.d.sync += answer.eq(Mux(full, Answer.COMPLETE, Answer.FAILED))
        with m.Elif(too_long):
            m.d.sync += answer.eq(Answer.FAILED)
        m.d.comb += self.complete.eq(answer == Answer.COMPLETE)

        with m.If(begins | takes):
            m.d.sync += bits.eq(Mux(begins, 0, bits) + takes)
        with m.If(takes):
            m.d.sync += self.word.eq(Cat(self.data, self.word))
        m.d.sync += self.since_rise.eq(
            Mux(begins, config.input_delay_ticks + 2, self.since_rise + 1)
        )

        if config.check:
            check = SerialCheck(
                config.check.width,
                config.check.polynomial,
                config.check.initial,
                config.check.final,
            )
            m.submodules.check = check
            before = begins | (bits < config.word_bits - config.check.width)
            m.d.comb += [
                check.restart.eq(begins),
                check.enable.eq(takes & before),
                check.bit.eq(self.data),
                self.check.eq(check.field),
            ]

        if config.guard_ticks:
            m.submodules.holding = holding = OneShot(config.guard_ticks)
            m.d.comb += holding.trigger.eq(takes)
            events[Cause.UNSTABLE] = self.data_edge & (takes | holding.active)
        if config.guard_ticks > 1:
            m.submodules.settling = settling = OneShot(config.guard_ticks - 1)
            m.d.comb += settling.trigger.eq(self.data_edge)
            events[Cause.UNSTABLE] |= takes & settling.active

        happened = Cat(events.values())
        m.d.sync += self.causes.eq(Mux(self.decided, 0, self.causes) | happened)
        return m
