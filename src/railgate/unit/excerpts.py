"""The spans of a run whose waves are kept: those about its events, near ones together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from railgate.unit.waves import Span

__all__ = ["Excerpts", "excerpts"]

BEFORE_S, AFTER_S = Fraction("0.06"), Fraction("0.1")
"""About an event: a system cycle before it, and two after it."""
LONGEST_S = 2
"""From an excerpt's begin to its last event."""
APART_S = Fraction(1, 1_000_000)
"""Between two excerpts: what makes their waves begins each one some ticks early."""
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
    for time_s in map(Fraction, times_s):
        end = min(time_s + AFTER_S, end_s)
        if spans and time_s <= max(spans[-1][0] + LONGEST_S, spans[-1][1] + APART_S):
            begin, until = spans[-1]
            near = time_s - BEFORE_S <= until
            if near:
                longer = max(until, end) if time_s <= begin + LONGEST_S else until
                total += longer - until
                spans[-1] = begin, longer
                of.append(len(spans) - 1)
                continue
        if total >= TOTAL_S:
            of.append(None)
            continue
        begin = max(time_s - BEFORE_S, spans[-1][1] + APART_S if spans else Fraction(0))
        total += end - begin
        spans.append((begin, end))
        of.append(len(spans) - 1)
    return Excerpts(tuple(spans), tuple(of))
