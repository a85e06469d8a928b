"""A whole run of what is outside the link."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, floor

import numpy as np
from numpy.typing import NDArray

from railgate.position_link.plant.effects import Draft, Hit
from railgate.position_link.plant.faults import FAULTS, Fault
from railgate.position_link.plant.plan import Plan
from railgate.position_link.plant.words import Words, of_train, row
from railgate.position_link.spec import Config
from railgate.waves import Trace

__all__ = ["Scenario", "controls", "drive"]

MOST_CYCLES = 2_000_000
"""About eleven hours; a cycle takes 2 KB."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Scenario:
    """A position system that answers, and what goes wrong with it. Raises ValueError.

    speed_kmh: mean speed of the train whose words it sends, see LAYOUT. words: what it sends
    instead, in each cycle the next, shape (n,), or (n, parts) of 64 bits each with the least
    significant part first; it begins again after the last. latency_clk: the CLK with which UEF
    rises; None: in the middle between the earliest and the last allowed. delay_ticks: cable and
    launch. faults: those that change answers count in their order, then those on the line. seed: of
    all that is random.
    """

    speed_kmh: float = 430.0
    words: NDArray[np.uint64] | None = None
    latency_clk: int | None = None
    delay_ticks: int = 2
    faults: tuple[Fault, ...] = ()
    seed: int = 0

    def __post_init__(self) -> None:
        for name, low, high in (("speed_kmh", 0, 1_000), ("seed", 0, (1 << 63) - 1)):
            value = getattr(self, name)
            if not low <= value <= high:
                raise ValueError(f"{name} must be between {low} and {high}, not {value}")
        if self.words is not None and not (self.words.ndim in (1, 2) and self.words.size):
            raise ValueError(
                f"words must be of shape (n,) or (n, parts), at least one, not {self.words.shape}"
            )

    def plan(self, config: Config, cycles: int) -> Plan:
        """What is done in each of so many cycles. Raises ValueError."""
        if not 1 <= cycles <= MOST_CYCLES:
            raise ValueError(f"cycles must be between 1 and {MOST_CYCLES}, not {cycles}")
        latency = self.latency_clk
        if latency is None:
            latency = (config.earliest_clk + config.window_bits) // 2
        none = np.zeros(cycles, np.int64)
        draft = Draft(
            Plan(
                config=config,
                words=_words(self, config, cycles),
                latency=none + latency,
                length=none + config.word_bits,
                second=none.copy(),
                second_length=none.copy(),
                delay=none + self.delay_ticks,
            )
        )
        numbered = list(enumerate(self.faults))
        for index, fault in sorted(numbered, key=lambda each: FAULTS[each[1].kind].on_line):
            random = np.random.default_rng([self.seed, index])
            FAULTS[fault.kind].effect(draft, _hit(fault, config, cycles, random))
        return draft.done()


def controls(scenario: Scenario, config: Config, cycles: int) -> Trace:
    """The inputs of a Loop that make it so; see Plan.controls. Raises ValueError."""
    return scenario.plan(config, cycles).controls()


def drive(scenario: Scenario, config: Config, cycles: int) -> Trace:
    """The link's pins `uef`, `data`, from tick 0 to the last cycle's end. Raises ValueError."""
    return scenario.plan(config, cycles).drive()


def _words(scenario: Scenario, config: Config, cycles: int) -> Words:
    """One for each cycle, not shared with the scenario."""
    if scenario.words is None:
        return of_train(config, cycles, scenario.speed_kmh, scenario.seed)
    words = scenario.words.reshape(scenario.words.shape[0], -1)
    parts = row(0, config).size
    if words.shape[1] != parts:
        raise ValueError(f"words must have {parts} parts of 64 bits each, not {words.shape[1]}")
    return words[np.arange(cycles) % words.shape[0]].astype(np.uint64)


def _hit(fault: Fault, config: Config, cycles: int, random: np.random.Generator) -> Hit:
    """Where the fault hits in a run of so many cycles. Raises ValueError where it is after it."""
    seconds = cycles * config.cycle_s
    if fault.start_s >= seconds:
        raise ValueError(
            f"{fault.kind} must begin before the run's end at {float(seconds):g} s, "
            f"not at {float(fault.start_s):g} s"
        )
    first = floor(fault.start_s / config.cycle_s)
    at = 1 + floor(fault.start_s * config.clock_hz)
    if fault.end_s is None:
        start, last = 1 + first * config.cycle_ticks, first + 1
        stop = start + config.cycle_ticks
    else:
        end = min(fault.end_s, seconds)
        start, last = at, ceil(end / config.cycle_s)
        stop = 1 + ceil(end * config.clock_hz)
    return Hit(
        kind=fault.kind,
        value=fault.value,
        cycles=slice(first, last),
        start=start,
        stop=stop,
        at=at,
        random=random,
    )
