"""A captured line read without a link: what `railgate decode` finds (LNK-3, LNK-4, LNK-7).

A capture has a time base of its own, so DATA is sampled with the captured CLK, whatever its rate.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from railgate.engines.inputs import filtered
from railgate.position_link.model.line import FAR, FOUND, LINE, NONE, complete, cycles, pulses
from railgate.position_link.model.words import Words, numbers, objections
from railgate.position_link.spec import Cause, Config, Edge
from railgate.waves import Waveform
from railgate.waves.waveform import Ticks

__all__ = ["Answer", "Reading", "read_line"]


@dataclass(frozen=True)
class Answer:
    """One answer, or one that did not come; ticks are the capture's.

    tick: of the request; without captured requests of UEF's rise or, with TIMEOUT, in which it
    was due. rise, fall: of UEF for this answer, None where there was none, fall also where it had
    not fallen by the end. bits: CLK that it lasted. word: None unless it has as many bits as it
    should. causes: all that was wrong.
    """

    tick: int
    rise: int | None
    fall: int | None
    bits: int
    word: int | None
    causes: Cause


@dataclass(frozen=True, eq=False)
class Reading:
    """All answers of a capture, in order of time, as arrays of shape (n,); iterable as Answers.

    rises, falls: NONE or FAR for None. words: where `complete`, else meaningless, shape (n, parts).
    requests: whether `ticks` are those of requests. cut: answers (with requests: cycles, but for
    what comes before the first one) of which the capture lacks a part, left out. bit_rate_hz: mean
    rate of CLK while it ran, None if it did not. clock_stops: how often it paused.
    """

    ticks: Ticks
    rises: Ticks
    falls: Ticks
    bits: Ticks
    words: Words
    complete: Any
    causes: Ticks
    requests: bool
    cut: int
    bit_rate_hz: float | None
    clock_stops: int

    def __len__(self) -> int:
        return self.ticks.size

    def __iter__(self) -> Iterator[Answer]:
        columns = (self.ticks, self.rises, self.falls, self.bits, self.complete, self.causes)
        rows = zip(*(column.tolist() for column in columns), numbers(self.words), strict=True)
        for tick, rise, fall, bits, whole, causes, word in rows:
            yield Answer(
                tick,
                None if rise == NONE else rise,
                None if fall in (NONE, FAR) else fall,
                bits,
                word if whole else None,
                Cause(causes),
            )


def read_line(
    clk: Waveform,
    uef: Waveform,
    data: Waveform,
    config: Config,
    period: Fraction,
    span: tuple[int, int],
    anf: Waveform | None = None,
    filter_ticks: int = 0,
) -> Reading:
    """Read the line over start ≤ tick < end.

    With ANF a cycle lasts from its rise to the next and is judged as the link does, the window
    counted in captured CLK; the last one too if the capture shows its decision. Without, every
    pulse of UEF is an answer, and TIMEOUT is told where after one the next is half a cycle
    overdue. What goes beyond the capture is left out, unless it is LONG already.
    period: seconds per tick. filter_ticks: levels of at most so many ticks are no levels, in all
    four signals; nothing is delayed. guard_ticks of the configuration are rounded down to these
    ticks. Levels at the start are no edges. Raises ValueError.
    """
    if not 0 <= filter_ticks <= 65_535:
        raise ValueError(f"filter_ticks must be between 0 and 65535, not {filter_ticks}")
    capture = Capture(config, period, span, filter_ticks, (clk, uef, data))
    return capture.cycles(anf) if anf else capture.pulses()


class Capture:
    """One capture: the edges of its signals, and a reader at its beginning."""

    def __init__(
        self,
        config: Config,
        period: Fraction,
        span: tuple[int, int],
        filter_ticks: int,
        waves: tuple[Waveform, ...],
    ) -> None:
        self.config, self.period, self.span, self.filter_ticks = config, period, span, filter_ticks
        (clk, level), (self.u, level_u), (self.d, level_d) = (self.edges(wave) for wave in waves)
        self.rises = clk[level::2].copy()
        rising = config.sampling_edge is Edge.RISING
        self.samples = self.rises if rising else clk[1 - level :: 2].copy()
        self.line = np.zeros(1, LINE)
        guard = int(Fraction(config.guard_ticks, config.clock_hz) / period)
        self.line["word_bits"], self.line["guard_ticks"] = config.word_bits, guard
        self.line["level_u"], self.line["level_d"] = level_u, level_d

    def edges(self, wave: Waveform) -> tuple[Ticks, int]:
        """The ticks in which a signal changes behind the filter, and its level before."""
        inside = wave.slice(*self.span)
        passed, _, _ = filtered(inside.ticks[1:], self.filter_ticks, self.span[1])
        return passed.copy(), int(inside.values[0])

    def cycles(self, anf: Waveform) -> Reading:
        config, (_, end) = self.config, self.span
        changes, level = self.edges(anf)
        starts = changes[level::2]
        after = np.append(starts, end)[1:]
        # The CLK that rises with the request: its edge may be seen one or the other way about.
        spacing = np.median(np.diff(self.rises)) if self.rises.size > 1 else 0
        first = np.searchsorted(self.rises, starts - int(spacing) // 2)
        opens = self.clock(first + config.earliest_clk - 1, starts, after)
        closes = self.clock(first + config.window_bits, after, after)
        decided = first + config.window_bits + config.word_bits + 1 < self.rises.size
        kept = np.append(np.ones(max(starts.size - 1, 0), bool), decided[-1:])
        spans = np.stack([starts, opens, closes, after - 1], axis=1)[kept]
        found, words = self.room(spans.shape[0])
        if len(spans):
            self.skip(int(starts[0]))
            base = np.zeros(len(spans), np.int64)
            cycles(self.line, self.samples, base, spans, self.u, self.d, words, found)
        cut = starts.size - len(spans)
        return self.reading(spans[:, 0], found, words, True, cut)

    def clock(self, index: Ticks, otherwise: Ticks, before: Ticks) -> Ticks:
        """The rises of CLK of these indices, or `otherwise` where it had none before `before`."""
        there = np.append(self.rises, FAR)[np.minimum(index, self.rises.size)]
        return np.where(there < before, there, otherwise)

    def skip(self, tick: int) -> None:
        """Leave out UEF before a tick."""
        at = int(np.searchsorted(self.u, tick))
        self.line["at_u"] = at
        self.line["level_u"] ^= at & 1

    def pulses(self) -> Reading:
        level = int(self.line["level_u"][0])
        u = self.u[level:]
        found, words = self.room((u.size + 1) // 2)
        pulses(self.line, self.samples, u, self.d, words, found)
        # One that has not ended is judged only where that changes nothing.
        kept = (found["fall"] != FAR) | (found["causes"] & int(Cause.LONG) != 0)
        cut = level + int((~kept).sum())
        found, words = found[kept], words[kept]
        due = self.due(found)
        missed = np.zeros(due.size, FOUND)
        missed["rise"] = missed["fall"] = NONE
        missed["causes"] = int(Cause.TIMEOUT)
        ticks = np.concatenate([found["rise"], due])
        order = np.argsort(ticks, kind="stable")
        found = np.concatenate([found, missed])[order]
        words = np.concatenate([words, self.room(due.size)[1]])[order]
        return self.reading(ticks[order], found, words, False, cut)

    def due(self, found: Any) -> Ticks:
        """Where answers should have come: a cycle after the last one, while UEF is low."""
        cycle = float(self.config.cycle_s / self.period)
        until = np.append(found["rise"], self.span[1])[1:] if found.size else found["rise"]
        missing = np.maximum(np.ceil((until - found["rise"]) / cycle - 0.5) - 1, 0).astype(np.int64)
        each = np.repeat(np.arange(found.size), missing)
        nth = np.arange(each.size) - np.repeat(np.cumsum(missing) - missing, missing) + 1
        due = found["rise"][each] + np.rint(nth * cycle).astype(np.int64)
        silent: Ticks = due[due >= found["fall"][each]]
        return silent

    def room(self, n: int) -> tuple[Any, Words]:
        return np.zeros(n, FOUND), np.zeros((n, -(-self.config.word_bits // 64)), np.uint64)

    def reading(self, ticks: Ticks, found: Any, words: Words, requests: bool, cut: int) -> Reading:
        whole = complete(found) & (found["fall"] != FAR)
        found["causes"] |= whole * objections(self.config, words)
        last = np.searchsorted(self.samples, np.minimum(found["fall"], self.span[1]))
        bits = np.where(
            found["rise"] == NONE, 0, last - np.searchsorted(self.samples, found["rise"])
        )
        rate, stops = self.bit_rate()
        return Reading(
            ticks=ticks,
            rises=found["rise"],
            falls=found["fall"],
            bits=bits,
            words=words,
            complete=whole,
            causes=found["causes"],
            requests=requests,
            cut=cut,
            bit_rate_hz=rate,
            clock_stops=stops,
        )

    def bit_rate(self) -> tuple[float | None, int]:
        """The mean rate of CLK where it runs, Hz, and how often it pauses: for two periods."""
        periods = np.diff(self.rises)
        if not periods.size:
            return None, 0
        running = periods < 2 * np.median(periods)
        rate = int(running.sum()) / (int(periods[running].sum()) * self.period)
        return float(rate), int((~running).sum())
