"""The position link's contract: configuration, fields, causes, and what happens in which tick.

Gateware and model are written from this page and from requirements LNK-1 … LNK-7, not from one
another. Ref: source 001, paragraphs 13 to 17.

**Ticks.** A tick is one period of the reference clock; `x[k]` is what x holds during tick k. Tick
0 is the first after reset (`rst` is 1 in tick k: tick k + 1 is a new tick 0 and all is as at
start). In one tick the events below take place in the order in which they stand here.

**Bit clock (LNK-1).** `bit_rate_hz / clock_hz` = `bits / ticks` in lowest terms. Cycle c = 0, 1, …
begins in tick C = 1 + c · `cycle_ticks` and has `cycle_bits` periods of CLK, n = 0, 1, …: its edge
`rise(n)` = ⌈n · ticks / bits⌉ and its edge `fall(n)` = ⌈(2n + 1) · ticks / (2 · bits)⌉ ticks after
C: `clk` is 1 in C + rise(n) ≤ k < C + fall(n), else 0; clk[0] = 0. *CLK m* of people, who count
from one, is period n = m - 1.

**Request (LNK-2).** `anf` is 1 in C ≤ k < C + rise(`request_bits`), else 0.

**Inputs (LNK-3).** Each of uef, data passes the synchroniser and filter that the odometer's
inputs pass too (primitives.FilteredInput): u[k], d[k] are the filtered levels, a rise, fall or
edge of them is in the tick in which the level is new, `input_delay_ticks` = 3 + filter_ticks = D
after the pin's; the level at start is no edge. Glitches rejected by either filter are counted.

Everything below happens D ticks after what it is about on the line, so that the delay of the
filters cancels out: a sample in tick k reads the pin of tick k - D.

**Start of a cycle**, in tick C + D. u[k] = 1 without a rise in this tick: STUCK. Nothing has been
seen and answered yet in this cycle.

**Window (LNK-4).** It is open in C + D + rise(`earliest_clk` - 1) ≤ k < C + D +
rise(`window_bits`), where window_bits is timeout_bits, counted from the end of ANF request_bits
more. UEF is *seen* where u[k] = 1 in a tick from the start of the cycle to the one before the
window closes. In the tick in which it closes, nothing seen: TIMEOUT.

**Rise of u.** Before the window of its cycle has opened: EARLY. In the open window, the first
such rise of its cycle: it begins the *answer*, of no bits yet. Else: UNREQUESTED (the cycle goes
on until the start of the next, in tick C + D).

**Fall of u.** Ends the answer under way: with `word_bits` bits it is complete, else SHORT.

**Sample**, in the tick C + D + fall(n) of every CLK, or with `sampling_edge` RISING C + D +
rise(n). With an answer under way (u[k] is 1 then): one that has word_bits bits already is ended,
LONG; else d[k] is its next bit, the most significant one first. Let such a bit be sampled in tick
s: an edge of d in a tick s - guard_ticks < k ≤ s + guard_ticks is UNSTABLE (DATA changes at the
sampling edge; with guard_ticks 0 never).

**Decision (LNK-5)**, in tick Q = C + `decision_ticks` = C + D + rise(window_bits + word_bits + 1):
by then every answer has ended. A complete word that fails `check` is CHECK, that is equal to the
fault word is FAULT_WORD, that is zero is ZERO_WORD where `zero_is_fault` says so. The cycle is
*good* if it has a complete word and, since the last decision, no cause; else *faulty*. (What
happens after a decision belongs to the next.) Faulty cycles in a row are counted, and good ones.
The link is *down* at start; `recovery_cycles` good cycles in a row bring it up,
`tolerated_cycles` faulty ones in a row bring it down. Of the cycle, after this:

- up, good: status FRESH, the word received, health OK.
- up, faulty: status HELD, the last good cycle's word, health WARNING.
- down: status FAULT, the fault word; health RECOVERING after a good cycle, ALARM after a faulty
  one, but START as long as since reset there were only faulty ones, fewer than tolerated_cycles.

`age` is 0 after a good cycle (down or up), else one more than before, up to its greatest value,
which it has at start. `causes` are those of the cycle.

**Delivery (LNK-6)**, in tick P = Q + `delivery_latency_ticks`: in it `delivery` is 1, else 0; in
it all fields change together, to what the decision has found, and stay until the next. The
`age_ticks` are P less the tick in which UEF's pin rose for the last good cycle's answer (a cycle
that was good while the link was down counts); they stay at their greatest value, which they have
before the first. The counts `…_cycles` are of cycles with that cause, each at most once a cycle.
At start the word is the fault word, status FAULT, age and age_ticks at their greatest, health
START, all else 0.

**Radio line.** Bits are launched with rising CLK and stay until the next, the first one in C +
rise(`radio_first`), the first rise after P: `radio_valid` is 1 and `radio_data` the bits of the
frame for `frame_bits` CLK, else both are 0. The frame is `frame_fields` one after the other, each
with its most significant bit first, its last field the check of all before; or with `bare` just
the word where the status is FRESH, else the fault word, for a radio unit that knows no age.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum, IntFlag
from fractions import Fraction
from functools import cache, cached_property
from math import ceil, floor

from railgate.bounds import require
from railgate.check import Check
from railgate.digest import digest
from railgate.field import Field

__all__ = [
    "CRC16",
    "EVEN",
    "ODD",
    "Cause",
    "Check",
    "Config",
    "Edge",
    "Field",
    "Health",
    "Status",
    "cause_names",
]


class Edge(IntEnum):
    """An edge of CLK."""

    FALLING = 0
    RISING = 1


class Status(IntEnum):
    """What the delivered word is."""

    FAULT = 0
    HELD = 1
    FRESH = 2


class Health(IntEnum):
    """The health of the link (LNK-7)."""

    START = 0
    OK = 1
    WARNING = 2
    ALARM = 3
    RECOVERING = 4


class Cause(IntFlag):
    """Why a cycle is faulty; several may hold (LNK-4, LNK-5, LNK-7)."""

    TIMEOUT = 1 << 0
    EARLY = 1 << 1
    SHORT = 1 << 2
    LONG = 1 << 3
    STUCK = 1 << 4
    UNREQUESTED = 1 << 5
    UNSTABLE = 1 << 6
    CHECK = 1 << 7
    FAULT_WORD = 1 << 8
    ZERO_WORD = 1 << 9


@cache
def cause_names(raised: int = ~0) -> tuple[str, ...]:
    """The names of these causes, by default of all, in their order and in lower case."""
    return tuple(cause.name.lower() for cause in Cause if cause.name and raised & cause)


EVEN = Check(width=1, polynomial=1)
ODD = Check(width=1, polynomial=1, final=1)
CRC16 = Check(width=16, polynomial=0x1021, initial=0xFFFF)
"""CRC-16/IBM-3740, the check of the radio line's frame."""


@dataclass(frozen=True, kw_only=True)
class Config:
    """What one position link is built for. Raises ValueError at the first thing that does not hold.

    clock_hz: reference clock, Hz. bit_rate_hz: of CLK, Hz. cycle_s: from request to request, s;
    both must come out even in one cycle. request_bits: width of ANF, CLK. timeout_bits: UEF comes
    within so many CLK of ANF's rise, or with `timeout_from_end` of its end. earliest_clk: the
    first CLK, counted from one, with which UEF may rise. word_bits: length of the word and of UEF,
    CLK. sampling_edge: the edge of CLK with which DATA is read. fault_word: None is all ones.
    zero_is_fault: the word zero is none. check: of the word, None where it has none: then a fault
    of DATA alone stays unseen. tolerated_cycles: faulty cycles in a row that bring the link down.
    recovery_cycles: good ones that bring it up. filter_ticks: levels of the inputs of at most so
    many ticks vanish. guard_ticks: DATA holds still so long before and after it is sampled. It must
    exceed what UEF and DATA differ in delay, and the tick of jitter that CLK has: with less, and
    with 0 always, an answer that changes at the sampling edge may be read wrong and look good.
    bare: the radio unit takes the bare word. count_bits, age_bits, age_ticks_bits: widths.
    """

    clock_hz: int = 40_000_000
    bit_rate_hz: Fraction = Fraction(512_000)
    cycle_s: Fraction = Fraction(1, 50)
    request_bits: int = 10
    timeout_bits: int = 30
    timeout_from_end: bool = False
    earliest_clk: int = 2
    word_bits: int = 64
    sampling_edge: Edge = Edge.FALLING
    fault_word: int | None = None
    zero_is_fault: bool = False
    check: Check | None = None
    tolerated_cycles: int = 3
    recovery_cycles: int = 1
    filter_ticks: int = 10
    guard_ticks: int = 4
    bare: bool = False
    count_bits: int = 32
    age_bits: int = 6
    age_ticks_bits: int = 32

    delivery_latency_ticks = 8
    """From decision to delivery: room for pipelines of any depth below it."""
    radio_check = CRC16

    def __post_init__(self) -> None:
        require(
            self,
            ("clock_hz", 1_000, 10**10),
            ("bit_rate_hz", 1, Fraction(self.clock_hz, 8)),
            ("cycle_s", Fraction(1, 10**6), 10),
            ("request_bits", 1, 1_000),
            ("timeout_bits", 1, 1_000),
            ("earliest_clk", 1, self.window_bits),
            ("word_bits", 8, 512),
            ("tolerated_cycles", 1, 255),
            ("recovery_cycles", 1, 255),
            ("filter_ticks", 0, 65_535),
            ("guard_ticks", 0, 65_535),
            ("count_bits", 8, 48),
            ("age_bits", 2, 16),
            ("age_ticks_bits", 16, 48),
        )
        self._require_even()
        self._require_fit()

    def _require_fit(self) -> None:
        """Raises ValueError unless what lies within a bit, a word and a cycle fits into it."""
        half = floor(Fraction(self.ticks, 2 * self.bits))
        if self.filter_ticks >= half:
            raise ValueError(
                f"filter_ticks must be below half a bit, at most {half - 1}, "
                f"not {self.filter_ticks}"
            )
        if 2 * self.guard_ticks >= half:
            raise ValueError(
                f"guard_ticks must be below a quarter of a bit, at most {(half - 1) // 2}, "
                f"not {self.guard_ticks}"
            )
        if self.fault_word is not None and not 0 <= self.fault_word < 1 << self.word_bits:
            raise ValueError(
                f"fault_word must have {self.word_bits} bits, not be {self.fault_word:#x}"
            )
        if self.check and self.check.width >= self.word_bits:
            raise ValueError(
                f"check must be narrower than the word's {self.word_bits} bits, "
                f"not {self.check.width}"
            )
        if self.request_bits >= self.cycle_bits:
            raise ValueError(
                f"request_bits must be below the cycle's {self.cycle_bits} CLK, "
                f"not {self.request_bits}"
            )
        if self.radio_first + self.frame_bits > self.cycle_bits:
            needed = self.radio_first + self.frame_bits
            raise ValueError(
                f"a cycle must hold answer and frame, at least {needed} bits, not {self.cycle_bits}"
            )

    def _require_even(self) -> None:
        """Raises ValueError unless ticks and bits come out even in one cycle; names the nearest."""
        for name, rate in (
            ("clock_hz", Fraction(self.clock_hz)),
            ("bit_rate_hz", self.bit_rate_hz),
        ):
            count = rate * self.cycle_s
            if count.denominator != 1:
                low, high = (float(n / self.cycle_s) for n in (floor(count), ceil(count)))
                raise ValueError(
                    f"{name} must give a whole number in {float(self.cycle_s):g} s, "
                    f"the nearest are {low:.12g} and {high:.12g}, not {float(rate):.12g}"
                )

    @cached_property
    def digest(self) -> int:
        """Of all of the configuration (SYS-5)."""
        return digest(self)

    @property
    def bits(self) -> int:
        """So many bits in `ticks` ticks, in lowest terms."""
        return (self.bit_rate_hz / self.clock_hz).numerator

    @property
    def ticks(self) -> int:
        return (self.bit_rate_hz / self.clock_hz).denominator

    @property
    def cycle_bits(self) -> int:
        return int(self.bit_rate_hz * self.cycle_s)

    @property
    def cycle_ticks(self) -> int:
        return int(self.clock_hz * self.cycle_s)

    def rise(self, n: int) -> int:
        """Ticks from the beginning of a cycle to the rising edge of period n of CLK."""
        return -(-n * self.ticks // self.bits)

    def fall(self, n: int) -> int:
        """Ticks from the beginning of a cycle to the falling edge of period n of CLK."""
        return -(-(2 * n + 1) * self.ticks // (2 * self.bits))

    @property
    def input_delay_ticks(self) -> int:
        """From a change of a pin to its edge behind the filter."""
        return 3 + self.filter_ticks

    @property
    def window_bits(self) -> int:
        """From ANF's rise to the timeout, CLK."""
        return self.timeout_bits + (self.request_bits if self.timeout_from_end else 0)

    @property
    def decision_ticks(self) -> int:
        """From the beginning of a cycle to its decision."""
        return self.input_delay_ticks + self.rise(self.window_bits + self.word_bits + 1)

    @property
    def delivery_ticks(self) -> int:
        """From the beginning of a cycle to its delivery."""
        return self.decision_ticks + self.delivery_latency_ticks

    @property
    def radio_first(self) -> int:
        """The period of CLK with which the frame's first bit is launched."""
        return (self.delivery_ticks * self.bits) // self.ticks + 1

    @property
    def invalid_word(self) -> int:
        """The fault word."""
        return (1 << self.word_bits) - 1 if self.fault_word is None else self.fault_word

    @property
    def fields(self) -> tuple[Field, ...]:
        """The fields of a delivery, each an output of that name."""
        never, old = (1 << self.age_bits) - 1, (1 << self.age_ticks_bits) - 1
        counts = tuple(
            Field(f"{name}_cycles", self.count_bits, "modulo its width", "cycles")
            for name in cause_names()
        )
        return (
            Field("number", self.count_bits, "of the delivery, from 1, modulo its width"),
            Field(
                "word",
                self.word_bits,
                "the last good word or the fault word",
                start=self.invalid_word,
            ),
            Field("status", 2, "what the word is, see Status"),
            Field("age", self.age_bits, "cycles since the last good one", "cycles", start=never),
            Field("age_ticks", self.age_ticks_bits, "since UEF rose for it", "ticks", start=old),
            Field("health", 3, "of the link, see Health"),
            Field("causes", len(Cause), "of this cycle, see Cause"),
            Field("faulty_cycles", self.count_bits, "modulo its width", "cycles"),
            Field("rejected_glitches", self.count_bits, "of both inputs, modulo its width"),
            *counts,
        )

    @property
    def frame_fields(self) -> tuple[Field, ...]:
        """The fields of the radio line's frame, the first one sent first."""
        word = Field("word", self.word_bits, "see status")
        if self.bare:
            return (word,)
        return (
            word,
            Field("status", 2, "what the word is, see Status"),
            Field("age", self.age_bits, "cycles since the last good one", "cycles"),
            Field("number", 8, "low bits of the delivery's number"),
            Field("check", self.radio_check.width, "of all bits before"),
        )

    @property
    def frame_bits(self) -> int:
        return sum(field.width for field in self.frame_fields)
