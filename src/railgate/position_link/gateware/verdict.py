"""Whether a cycle was good, from what the line and the word showed."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.position_link.gateware.reader import LINE_CAUSES
from railgate.position_link.spec import Cause, Config

__all__ = ["Verdict"]

CHUNK_BITS = 4
"""So many bits become one in one tick."""


class Verdict(wiring.Component):
    """The causes of a cycle; it is good if it has a complete word and none of them.

    decided: in, 1 bit, see Timing. seen, complete, word, check: in, see Reader; all but the first
    hold still until the fields change, a word and its check from before the decision on.
    causes: out, registers, see Cause, two ticks after `decided` at the latest. good: out, register,
    one tick later. Both stay until the next `decided`. Requirement LNK-5.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        super().__init__(
            {
                "decided": In(1),
                "seen": In(len(LINE_CAUSES)),
                "complete": In(1),
                "word": In(config.word_bits),
                "causes": Out(len(Cause)),
                "good": Out(1),
            }
            | ({"check": In(config.check.width)} if config.check else {})
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        config = self._config

        line = Signal(len(LINE_CAUSES))
        clear = Signal(init=1)  # nothing in line
        with m.If(self.decided):
            m.d.sync += [line.eq(self.seen), clear.eq(self.seen == 0)]

        check_fails = Signal()
        is_fault_word = Signal()
        is_zero = Signal()
        if config.check:
            differs = _any(m, self.word[: config.check.width] ^ self.check, "check_differs")
            m.d.sync += check_fails.eq(self.complete & differs)
        differs = _any(m, self.word ^ config.invalid_word, "fault_word_differs")
        m.d.sync += is_fault_word.eq(self.complete & ~differs)
        if config.zero_is_fault:
            m.d.sync += is_zero.eq(self.complete & ~_any(m, self.word, "nonzero"))
        of_word = Cat(check_fails, is_fault_word, is_zero)
        sound = Signal()
        m.d.comb += self.causes.eq(Cat(line, of_word))
        m.d.sync += [
            sound.eq(self.complete & (of_word == 0)),
            self.good.eq(sound & clear),
        ]
        return m


def _any(m: Module, bits: Value, name: str) -> Value:
    """Whether any bit is set: by registers of some ticks ago, chunk by chunk to the last one."""
    stage = 0
    while len(bits) > 1:
        chunks = [bits[at : at + CHUNK_BITS].any() for at in range(0, len(bits), CHUNK_BITS)]
        bits = Signal(len(chunks), name=f"{name}_{stage}")
        m.d.sync += bits.eq(Cat(chunks))
        stage += 1
    return bits
