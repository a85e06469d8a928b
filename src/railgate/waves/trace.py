"""A set of signals with one time base."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

import numpy as np

from railgate.waves.waveform import Ticks, Waveform

__all__ = ["Difference", "Trace", "absent", "rescale"]

BLOCK = 1 << 16


def rescale(ticks: Ticks, ratio: Fraction) -> Ticks:
    """ceil(ticks · ratio) of rising ticks, exact; raises ValueError where one leaves 64 bits."""
    up, down = ratio.numerator, ratio.denominator
    if up == down or not ticks.size:
        return ticks
    limits = np.iinfo(np.int64)
    for extreme in (int(ticks[0]), int(ticks[-1])):
        if not limits.min <= -(-extreme * up // down) <= limits.max:
            raise ValueError(f"tick {extreme} times {ratio} leaves 64 bits")
    if up > limits.max or down * min(up, down) > limits.max:
        return _rescale_wide(ticks, up, down)
    whole, rest = np.divmod(ticks, down)
    above, part = divmod(up, down)
    # The sum fits 64 bits, and rest · part too; a partial sum that does not wraps and comes back.
    scaled: Ticks = whole * up + rest * above - (-(rest * part) // down)
    return scaled


def _rescale_wide(ticks: Ticks, up: int, down: int) -> Ticks:
    """`rescale` in integers of any size, which take ten times the memory: block by block."""
    scaled = np.empty(ticks.size, np.int64)
    for first in range(0, ticks.size, BLOCK):
        part = slice(first, first + BLOCK)
        scaled[part] = -(-ticks[part].astype(object) * up // down)
    return scaled


def absent(name: str, there: Sequence[str]) -> ValueError:
    """The error for a channel that is not there; it lists those there are (at most 40)."""
    listed = ", ".join(there[:40]) or "none"
    more = f" and {len(there) - 40} more" if len(there) > 40 else ""
    return ValueError(f'no channel "{name}"; there are: {listed}{more}')


@dataclass(frozen=True)
class Difference:
    """The first place where two traces part: signal, tick, and what each holds there.

    signal: a signal's name; "the end", "the start", "the width of x" or "the sign of x" (1 where
    x is signed) where it is that in which they differ.
    """

    signal: str
    tick: int
    left: int | None
    right: int | None

    def __str__(self) -> str:
        return f"{self.signal} at tick {self.tick}: {self.left} against {self.right}"


@dataclass(frozen=True, eq=False)
class Trace:
    """Named waveforms over start ≤ tick < end, each beginning at `start`.

    signals: name -> Waveform, in the order in which they are shown.
    period: seconds per tick, exact. Tick k is the time from k·period until (k + 1)·period.
    """

    signals: Mapping[str, Waveform]
    period: Fraction
    start: int
    end: int

    def __post_init__(self) -> None:
        if self.period <= 0:
            raise ValueError(f"a tick's period must be above 0 s, not {self.period}")
        if self.end < self.start:
            raise ValueError(f"a trace must not end before its start, {self.end} < {self.start}")
        if self.start < -(1 << 63) or self.end >= 1 << 63:
            raise ValueError(f"a trace's ticks must fit 64 bits, not {self.start}..{self.end}")
        for name, wave in self.signals.items():
            if wave.ticks[0] != self.start:
                raise ValueError(
                    f'"{name}" must begin at the trace\'s start, tick {self.start}, '
                    f"not {wave.ticks[0]}"
                )
            if wave.ticks[-1] >= max(self.end, self.start + 1):
                raise ValueError(
                    f'"{name}" must end before the trace\'s end, tick {self.end}, '
                    f"not {wave.ticks[-1]}"
                )

    @property
    def duration_s(self) -> Fraction:
        return (self.end - self.start) * self.period

    def __getitem__(self, name: str) -> Waveform:
        try:
            return self.signals[name]
        except KeyError:
            raise absent(name, list(self.signals)) from None

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Trace):
            return NotImplemented
        mine, its = (self.period, self.start, self.end), (other.period, other.start, other.end)
        return mine == its and dict(self.signals) == dict(other.signals)

    __hash__ = None  # type: ignore[assignment]

    def _with(self, signals: Mapping[str, Waveform]) -> Trace:
        return Trace(signals, self.period, self.start, self.end)

    def select(self, names: Iterable[str]) -> Trace:
        """Only the signals named, in that order."""
        return self._with({name: self[name] for name in names})

    def rename(self, names: Mapping[str, str]) -> Trace:
        """The same signals, those in `names` under their new name."""
        for old in names:
            self[old]
        after = [names.get(name, name) for name in self.signals]
        for name, times in Counter(after).items():
            if times > 1:
                raise ValueError(f'signals must keep different names, not be two of "{name}"')
        return self._with({names.get(name, name): wave for name, wave in self.signals.items()})

    def merge(self, other: Trace) -> Trace:
        """The signals of both, which must share time base and span and no name."""
        if (self.period, self.start, self.end) != (other.period, other.start, other.end):
            raise ValueError("only traces of one time base and span can be merged")
        if both := self.signals.keys() & other.signals.keys():
            raise ValueError(f"both traces have the signals {', '.join(sorted(both))}")
        return self._with({**self.signals, **other.signals})

    def slice(self, start: int, end: int) -> Trace:
        """The part in start ≤ tick < end, which must lie inside the trace."""
        if not self.start <= start <= end <= self.end:
            raise ValueError(
                f"a slice must lie inside ticks {self.start}..{self.end}, not {start}..{end}"
            )
        signals = {name: wave.slice(start, end) for name, wave in self.signals.items()}
        return Trace(signals, self.period, start, end)

    def shift(self, ticks: int) -> Trace:
        """The same trace, `ticks` later."""
        signals = {name: wave.shift(ticks) for name, wave in self.signals.items()}
        return Trace(signals, self.period, self.start + ticks, self.end + ticks)

    def extend(self, end: int) -> Trace:
        """The same trace with the last values held until `end`."""
        return Trace(self.signals, self.period, self.start, max(end, self.end))

    def resample(self, period: Fraction) -> Trace:
        """What a sampler of another clock sees: at its tick j the value of time j · period.

        A change between two of its ticks is seen at the later one, of several only the last.
        Raises ValueError where a tick leaves 64 bits.
        """
        ratio = self.period / period
        start, end = (int(t) for t in rescale(np.array([self.start, self.end]), ratio))
        last = max(end, start + 1) - 1
        signals = {}
        for name, wave in self.signals.items():
            ticks = rescale(wave.ticks, ratio)
            seen = ticks <= last
            signals[name] = Waveform.of(ticks[seen], wave.values[seen], wave.width, wave.signed)
        return Trace(signals, period, start, end)

    def concatenate(self, *others: Trace) -> Trace:
        """This trace and those that follow it, each beginning where the one before it ends.

        All carry the same signals, with the same widths. Raises ValueError.
        """
        for before, after in pairwise((self, *others)):
            before._check_followed_by(after)
        pieces = [piece for piece in (self, *others) if piece.end > piece.start] or [self]
        if len(pieces) == 1:
            return pieces[0]
        signals = {
            name: Waveform.of(
                np.concatenate([piece.signals[name].ticks for piece in pieces]),
                np.concatenate([piece.signals[name].values for piece in pieces]),
                wave.width,
                wave.signed,
            )
            for name, wave in self.signals.items()
        }
        return Trace(signals, self.period, self.start, pieces[-1].end)

    def _check_followed_by(self, other: Trace) -> None:
        if (self.period, self.end) != (other.period, other.start):
            raise ValueError(
                f"the next trace must begin at tick {self.end} of {self.period} s, "
                f"not at {other.start} of {other.period} s"
            )
        if self.signals.keys() != other.signals.keys():
            odd = ", ".join(sorted(self.signals.keys() ^ other.signals.keys()))
            raise ValueError(f"both traces must carry the same signals; only one has: {odd}")
        for name, wave in self.signals.items():
            then = other.signals[name]
            if (wave.width, wave.signed) != (then.width, then.signed):
                raise ValueError(
                    f'"{name}" must keep its width of {wave.width} bits and its sign, '
                    f"not become {then.width} bits wide"
                )

    def first_difference(self, other: Trace) -> Difference | None:
        """The earliest difference of the two, or None where they are equal.

        A missing signal and another width, sign or end count; the former three at the start.
        """
        if self.period != other.period:
            raise ValueError(
                f"traces with ticks of {self.period} s and {other.period} s cannot be compared"
            )
        for name in (*self.signals, *other.signals):
            if name not in self.signals or name not in other.signals:
                mine, its = self.signals.get(name), other.signals.get(name)
                return Difference(
                    name,
                    self.start,
                    None if mine is None else int(mine.values[0]),
                    None if its is None else int(its.values[0]),
                )
        first = min(self.start, other.start)
        found = []
        if self.end != other.end:
            found.append(Difference("the end", min(self.end, other.end), self.end, other.end))
        if self.start != other.start and not self.signals:
            found.append(Difference("the start", first, self.start, other.start))
        for name, wave in self.signals.items():
            its = other[name]
            for what, left, right in (
                ("width", wave.width, its.width),
                ("sign", int(wave.signed), int(its.signed)),
            ):
                if left != right:
                    found.append(Difference(f"the {what} of {name}", first, left, right))
            tick = wave.first_difference(its)
            if tick is not None:
                values = (w.at(tick) if tick >= w.ticks[0] else None for w in (wave, its))
                found.append(Difference(name, tick, *(v if v is None else int(v) for v in values)))
        return min(found, key=lambda difference: difference.tick, default=None)
