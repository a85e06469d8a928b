"""The safety property held against a run: how long contacts stayed closed (DRV-16)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from railgate.vital_output.observed import Observed
from railgate.vital_output.plant.edges import FEMTOSECOND
from railgate.vital_output.spec import Config
from railgate.waves import Waveform
from railgate.waves.waveform import Ticks

__all__ = ["Closing", "Verdict", "judge"]


@dataclass(frozen=True, kw_only=True)
class Closing:
    """A span in which the contact of one output was closed without a break.

    closed, opened: its beginning and end, femtoseconds. lasts: it ends with the run. live: when the
    last byte came of the last frame with a 1 for this output that a channel had stored by the end,
    of both channels' the later one; None where there was none. zero: a later frame, with a 0, was
    stored by the end. late: it began later than the reaction time after `live`, or without one.
    """

    output: int
    closed: int
    opened: int
    lasts: bool
    live: int | None
    zero: bool
    late: bool

    @property
    def since_live_s(self) -> Fraction | None:
        """From the last agreed, live 1 to the end."""
        return None if self.live is None else (self.opened - self.live) * FEMTOSECOND

    @property
    def unbacked_s(self) -> Fraction:
        """How long it was closed with no agreed, live 1 any more: what is bounded."""
        backed = self.closed if self.live is None else max(self.closed, self.live)
        return (self.opened - backed) * FEMTOSECOND

    @property
    def opened_by(self) -> str | None:
        """`command`, a stored 0, or `failure`, whatever else; None where it is still closed."""
        if self.lasts:
            return None
        return "command" if self.zero and not self.late else "failure"


@dataclass(frozen=True)
class Verdict:
    """declared_s: the reaction time. closings: of all outputs, in order of time."""

    declared_s: Fraction
    closings: tuple[Closing, ...]

    @property
    def violations(self) -> tuple[Closing, ...]:
        """The spans that lasted too long."""
        return tuple(filter(self.too_long, self.closings))

    def too_long(self, each: Closing) -> bool:
        """It lasted longer than the reaction time after the last agreed, live 1."""
        return each.unbacked_s > self.declared_s

    def worst_s(self, opened_by: str) -> Fraction | None:
        """The longest that a contact took from the last agreed, live 1 until it opened, of those
        that were closed on such a 1; None where there was none."""
        found = [
            each.since_live_s
            for each in self.closings
            if each.opened_by == opened_by and each.since_live_s is not None and not each.late
        ]
        return max(found, default=None)


def judge(config: Config, contact: Waveform, end: int, channels: Sequence[Observed]) -> Verdict:
    """Of a run until the femtosecond `end`, seen by both channels; contact: bit i of output i."""
    stores = [_Stores.of(channel) for channel in channels]
    closings = [
        _closing(config, output, *span, end, stores)
        for output in range(config.outputs)
        for span in _spans(contact, output, end)
    ]
    closings.sort(key=lambda each: each.closed)
    return Verdict(config.reaction_s, tuple(closings))


@dataclass(frozen=True)
class _Stores:
    """Of each frame that a channel stored: when it was stored, when its last byte came, which
    outputs it commands 0, and which 1: live is only what the image then has too, not what a latch
    keeps out."""

    at: Ticks
    sent: Ticks
    zeros: NDArray[np.uint64]
    ones: NDArray[np.uint64]

    @classmethod
    def of(cls, channel: Observed) -> _Stores:
        rows = [(at, frame.at, frame.image) for at, frame in channel.stores]
        at, sent, images = zip(*rows, strict=True) if rows else ((), (), ())
        commands, when = np.array(images, np.uint64), np.array(at, np.int64)
        live = channel.wave("image").at(when).astype(np.uint64)
        return cls(when, np.array(sent, np.int64), ~commands, commands & live)

    def sent_by(self, end: int, output: int, bit: int) -> list[int]:
        """The last bytes of those that were stored by `end` and command the output this bit."""
        commands = self.ones if bit else self.zeros
        has = (commands >> np.uint64(output) & np.uint64(1)) == 1
        sent: list[int] = self.sent[has & (self.at <= end)].tolist()
        return sent


def _spans(contact: Waveform, output: int, end: int) -> Iterable[tuple[int, int]]:
    """Each maximal span in which the contact of an output is closed."""
    wave = Waveform.of(contact.ticks, contact.values >> output & 1)
    ends = [*wave.ticks[1:].tolist(), end]
    for start, stop, closed in zip(wave.ticks.tolist(), ends, wave.values.tolist(), strict=True):
        if closed:
            yield start, stop


def _closing(
    config: Config, output: int, closed: int, opened: int, end: int, stores: Sequence[_Stores]
) -> Closing:
    ones, zeros = (
        [sent for each in stores for sent in each.sent_by(opened, output, bit)] for bit in (1, 0)
    )
    live = max(ones, default=None)
    return Closing(
        output=output,
        closed=closed,
        opened=opened,
        lasts=opened == end,
        live=live,
        zero=max(zeros, default=-1) > (-1 if live is None else live),
        late=live is None or (closed - live) * FEMTOSECOND > config.reaction_s,
    )
