"""How each kind of fault changes what position system and line do."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from railgate.position_link.plant.clk import Clk
from railgate.position_link.plant.plan import Plan
from railgate.position_link.plant.words import row
from railgate.position_link.spec import Config
from railgate.waves import Waveform
from railgate.waves.waveform import Ticks

__all__ = [
    "Draft",
    "Effect",
    "Hit",
    "answers_at",
    "bit_error",
    "drift",
    "glitch",
    "lasts",
    "missing",
    "noise",
    "second",
    "sends",
    "stuck",
    "unplugged",
    "unrequested",
]

MOST_CHANGES = 10_000_000
"""Of noise on each line."""

MOST_TICKS = 1 << 40


@dataclass(frozen=True, kw_only=True)
class Hit:
    """Where one fault hits: these cycles; ticks start ≤ k < stop; or tick `at` and each one that is
    whole cycles later, before `stop`."""

    kind: str
    value: int | None
    cycles: slice
    start: int
    stop: int
    at: int
    random: np.random.Generator

    def given(self, default: int, low: int, high: int) -> int:
        """The fault's value. Raises ValueError outside low … high."""
        value = default if self.value is None else self.value
        if not low <= value <= high:
            raise ValueError(
                f"the value of {self.kind} must be between {low} and {high}, not {value}"
            )
        return value


@dataclass
class Draft:
    """A plan whose arrays still change, and when each line's input is to be 1."""

    plan: Plan
    held: dict[str, list[tuple[Ticks, Ticks]]] = field(default_factory=dict)

    @property
    def config(self) -> Config:
        return self.plan.config

    def hold(self, line: str, starts: Ticks, stops: Ticks) -> None:
        """That input is 1 in each start ≤ k < stop; of flips that overlap two cancel out."""
        self.held.setdefault(line, []).append((starts, stops))

    def done(self) -> Plan:
        """The plan with its lines. Raises ValueError where a value has left its bounds."""
        return replace(self.plan, lines={line: self._wave(line) for line in self.held})

    def _wave(self, line: str) -> Waveform:
        starts, stops = (np.concatenate(ticks) for ticks in zip(*self.held[line], strict=True))
        ticks = np.concatenate([starts, stops])
        order = np.argsort(ticks, kind="stable")
        held = np.cumsum(np.where(order < starts.size, 1, -1))
        level = held & 1 if line.endswith("flip") else held > 0
        inside = np.searchsorted(ticks[order], self.plan.end)
        return Waveform.of(np.append(0, ticks[order][:inside]), np.append(0, level[:inside]))


Effect = Callable[[Draft, Hit], None]


def missing(draft: Draft, hit: Hit) -> None:
    draft.plan.latency[hit.cycles] = 0


def answers_at(default: Callable[[Config], int]) -> Effect:
    """UEF rises with the CLK of the fault's value."""

    def effect(draft: Draft, hit: Hit) -> None:
        value = hit.given(default(draft.config), 1, draft.config.cycle_bits)
        draft.plan.latency[hit.cycles] = value

    return effect


def lasts(default: Callable[[Config], int]) -> Effect:
    """UEF lasts so many CLK as the fault's value says."""

    def effect(draft: Draft, hit: Hit) -> None:
        value = hit.given(default(draft.config), 1, draft.config.cycle_bits)
        draft.plan.length[hit.cycles] = value

    return effect


def second(draft: Draft, hit: Hit) -> None:
    config, plan = draft.config, draft.plan
    after = plan.latency[hit.cycles] + plan.length[hit.cycles] + 1
    if hit.value is not None:
        after = np.full_like(after, hit.given(0, 1, config.cycle_bits))
    plan.second[hit.cycles] = after
    plan.second_length[hit.cycles] = config.word_bits


def unrequested(draft: Draft, hit: Hit) -> None:
    most = draft.config.cycle_bits
    draft.plan.second[hit.cycles] = hit.given(most * 3 // 4, 1, most)
    draft.plan.second_length[hit.cycles] = 2


def drift(draft: Draft, hit: Hit) -> None:
    half = draft.config.ticks // (2 * draft.config.bits)
    value = hit.given(min(half, 128), -255, 255)
    delay = draft.plan.delay
    count = hit.cycles.stop - hit.cycles.start
    delay[hit.cycles] += value * np.arange(1, count + 1) // count
    delay[hit.cycles.stop :] += value


def sends(word: Callable[[Config], int]) -> Effect:
    """The position system sends this word."""

    def effect(draft: Draft, hit: Hit) -> None:
        draft.plan.words[hit.cycles] = row(word(draft.config), draft.config)

    return effect


def bit_error(draft: Draft, hit: Hit) -> None:
    config, plan = draft.config, draft.plan
    bit = hit.given(1, 1, config.word_bits)
    latency, delay = plan.latency[hit.cycles], plan.delay[hit.cycles]
    there = (latency > 0) & (plan.length[hit.cycles] >= bit)
    cycle = np.arange(hit.cycles.start, hit.cycles.stop)
    period = (cycle * config.cycle_bits + latency - 1 + bit - 1)[there]
    launch = Clk(config).launch
    draft.hold("line.data.flip", launch(period) + delay[there], launch(period + 1) + delay[there])


def stuck(draft: Draft, hit: Hit) -> None:
    level = hit.given(1, 0, 1)
    draft.hold(f"line.uef.{('low', 'high')[level]}", *_throughout(hit))


def unplugged(level: str) -> Effect:
    """UEF and DATA both hold the level."""

    def effect(draft: Draft, hit: Hit) -> None:
        for pin in ("uef", "data"):
            draft.hold(f"line.{pin}.{level}", *_throughout(hit))

    return effect


def noise(draft: Draft, hit: Hit) -> None:
    mean = hit.given(max(1, draft.config.ticks // (2 * draft.config.bits)), 1, MOST_TICKS)
    for pin in ("uef", "data"):
        count = hit.random.poisson((hit.stop - hit.start) / mean)
        if count > MOST_CHANGES:
            raise ValueError(f"noise must be at most {MOST_CHANGES} changes, not {count}")
        ticks = np.sort(hit.random.integers(hit.start, hit.stop, 2 * (count // 2)))
        draft.hold(f"line.{pin}.flip", ticks[::2], ticks[1::2])


def glitch(draft: Draft, hit: Hit) -> None:
    ticks = hit.given(max(1, draft.config.filter_ticks), 1, draft.config.cycle_ticks)
    starts = np.arange(hit.at, hit.stop, draft.config.cycle_ticks)
    draft.hold("line.uef.flip", starts, starts + ticks)


def _throughout(hit: Hit) -> tuple[Ticks, Ticks]:
    return np.array([hit.start]), np.array([hit.stop])
