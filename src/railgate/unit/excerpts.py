"""The spans of a run whose waves are kept: those about its events, near ones together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from railgate.unit.waves import Span

__all__ = ["Excerpts", "excerpts"]

BEFORE_S, AFTER_S = Fraction("0.06"), Fraction("0.1")
"""About an event: the system cycle before it, and the two after it."""
LONGEST_S = 2
"""From an excerpt's begin to its last event."""
APART_S = Fraction(1, 1_000_000)
"""Between two excerpts: the engines begin each one a few ticks early."""
TOTAL_S = 60
"""Of all excerpts: a run of nothing but events would be written down as a whole."""


@dataclass(frozen=True)
class Excerpts:
    """spans: in order, apart from one another. of: of each event its span's number, None where
    there were too many events before it."""

    spans: tuple[Span, ...]
    of: tuple[int | None, ...]

    @staticmethod
    def name(number: int) -> str:
        """Of an excerpt's files, without suffix: they count from 001."""
        return f"{number + 1:03}"


def excerpts(times_s: Sequence[float], end_s: Fraction) -> Excerpts:
    """Those about these times, rising, of a run that ends at end_s."""
    spans: list[Span] = []
    of: list[int | None] = []
    total = Fraction(0)
    for time in map(Fraction, times_s):
        begin, end = max(time - BEFORE_S, Fraction(0)), min(time + AFTER_S, end_s)
        if spans and begin <= spans[-1][1]:
            first, last = spans[-1]
            if time <= max(first + LONGEST_S, last + APART_S):
                until = max(last, end if time <= first + LONGEST_S else time)
                total += until - last
                spans[-1] = first, until
                of.append(len(spans) - 1)
                continue
            begin = last + APART_S
        if total >= TOTAL_S or begin >= end:
            of.append(None)
            continue
        total += end - begin
        spans.append((begin, end))
        of.append(len(spans) - 1)
    return Excerpts(tuple(spans), tuple(of))
