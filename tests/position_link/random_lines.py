"""Configurations of every kind, and lines that toggle where the contract has its boundaries."""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache
from random import Random

import numpy as np
from hypothesis import strategies as st

from position_link.stimuli import good_word, short
from railgate.position_link.spec import CRC16, EVEN, ODD, Check, Config, Edge
from railgate.waves import Trace, Waveform

Toggles = dict[str, list[int]]

WIDTHS = (8, 9, 20, 63, 64, 65, 130)
BOOLEANS = st.booleans()


@st.composite
def checks(draw: st.DrawFn, word_bits: int) -> Check | None:
    found = draw(st.sampled_from((None, None, EVEN, ODD, CRC16, "any")))
    if found == "any":
        width = draw(st.integers(1, min(word_bits - 1, 64)))
        top = (1 << width) - 1
        polynomial, initial, final = (draw(st.integers(low, top)) for low in (1, 0, 0))
        return Check(width=width, polynomial=polynomial, initial=initial, final=final)
    return found if found and found.width < word_bits else None


@st.composite
def configs(draw: st.DrawFn, widths: Sequence[int] = WIDTHS) -> Config:
    """Cycles hardly longer than they have to be; filter and guard up to their limits."""
    word_bits = draw(st.sampled_from(widths))
    timeout, from_end = draw(st.integers(1, 9)), draw(BOOLEANS)
    request = draw(st.integers(1, 9) if from_end else st.sampled_from((1, 2, 5, 9, 40)))
    config = short(
        draw(st.fractions(8, 30, max_denominator=50)),
        draw(st.integers(1, 5)),
        request_bits=request,
        timeout_bits=timeout,
        timeout_from_end=from_end,
        earliest_clk=draw(st.integers(1, timeout + request * from_end)),
        word_bits=word_bits,
        sampling_edge=draw(st.sampled_from(Edge)),
        fault_word=draw(st.none() | st.integers(0, (1 << word_bits) - 1)),
        zero_is_fault=draw(BOOLEANS),
        check=draw(checks(word_bits)),
        tolerated_cycles=draw(st.integers(1, 5)),
        recovery_cycles=draw(st.integers(1, 4)),
        filter_ticks=0,
        guard_ticks=0,
        bare=draw(BOOLEANS),
        count_bits=draw(st.integers(8, 9)),
        age_bits=draw(st.integers(2, 3)),
        age_ticks_bits=draw(st.integers(16, 17)),
    )
    half = config.ticks // (2 * config.bits)
    filter_ticks, guard_ticks = (
        draw(st.integers(0, half - 1)),
        draw(st.integers(0, (half - 1) // 2)),
    )
    return replace(config, filter_ticks=filter_ticks, guard_ticks=guard_ticks)


@cache
def sampled(config: Config) -> list[int]:
    """The samples of two cycles, in ticks from the beginning of the first."""
    edge = config.rise if config.sampling_edge is Edge.RISING else config.fall
    return [edge(n) for n in range(2 * config.cycle_bits)]


def mostly(random: Random, right: Sequence[int], wrong: Sequence[int]) -> int:
    return random.choice(right if random.random() < 0.9 else wrong)


def any_word(config: Config, random: Random) -> int:
    right = good_word(config, random.getrandbits(config.word_bits))
    top = config.word_bits - 1
    flip = 1 << random.choice((0, top, random.randrange(top)))
    word = mostly(random, (right,), (0, config.invalid_word, right ^ flip, flip))
    return word if random.random() < 0.95 else config.invalid_word ^ flip


def answer(config: Config, random: Random) -> Toggles:
    """Toggles from the beginning of a cycle: most often all is well, if only just."""
    samples, guard = sampled(config), config.guard_ticks
    opens, closes = config.rise(config.earliest_clk - 1), config.rise(config.window_bits)
    inside, anywhere = random.randrange(opens, closes), random.randrange(config.cycle_ticks)
    rise = mostly(random, (opens, closes - 1, inside, inside), (opens - 1, closes, anywhere))
    first = bisect_left(samples, rise)
    last, over = samples[first + config.word_bits - 1], samples[first + config.word_bits]
    right = (last + 1, over, random.randint(last + 1, over))
    fall = mostly(random, right, (last, over + 1, over + config.rise(1), rise + anywhere))
    bit = over - last
    leads = (guard, bit - guard - 2, bit // 2, bit // 2)
    lead = mostly(random, leads, (guard - 1, bit - guard, random.randrange(bit)))
    word = any_word(config, random) << 1
    changes = (word ^ word >> 1) & (1 << config.word_bits + 1) - 1
    data = [
        samples[first + n] - lead
        for n in range(config.word_bits + 1)
        if changes >> config.word_bits - n & 1
    ]
    return {"uef": [rise, fall], "data": data}


def pulse(config: Config, random: Random) -> Toggles:
    """One of either input at a boundary of the cycle, about as long as the filter or a bit."""
    samples = sampled(config)[: config.cycle_bits]
    window = config.earliest_clk - 1, config.window_bits, config.window_bits + config.word_bits + 1
    marks = [0, *(config.rise(n) for n in window), random.choice(samples), random.choice(samples)]
    reach = config.guard_ticks + 1
    at = random.choice(marks) + random.randint(-reach, reach)
    lengths = (1, config.filter_ticks, config.filter_ticks + 1, config.rise(random.randint(1, 9)))
    return {random.choice(("uef", "data")): [at, at + random.choice(lengths)]}


def burst(config: Config, random: Random) -> Toggles:
    """Toggles of one input with random gaps, anywhere."""
    gaps = (1, 1, 2, config.filter_ticks, config.filter_ticks + 1, config.rise(1))
    at, ticks = random.randrange(config.cycle_ticks), []
    for _ in range(random.randint(1, 40)):
        at += random.choice(gaps)
        ticks.append(at)
    return {random.choice(("uef", "data")): ticks}


def toggling(ticks: list[int], end: int) -> Waveform:
    """From 0 on; two toggles in one tick are none, one before tick 0 is in tick 0."""
    counts = Counter(max(tick, 0) for tick in ticks)
    odd = sorted(tick for tick, count in counts.items() if count % 2 and tick < end)
    return Waveform.of([0, *odd], np.arange(len(odd) + 1) & 1)


def line(config: Config, seed: int, cycles: int, resets: bool = True) -> Trace:
    """uef, data and rst over some more than so many cycles, which start anew after each reset."""
    random = Random(seed)
    toggles: Toggles = {
        "uef": random.choice(([], [], [0])),
        "data": random.choice(([], [0])),
        "rst": [],
    }
    end = cycles * config.cycle_ticks + random.randrange(1, config.cycle_ticks)
    calm, origin = random.random(), 0
    while origin < end:
        stop = random.randrange(origin, 2 * end) if resets else end
        for begin in range(origin + 1, min(stop, end), config.cycle_ticks):
            kinds = [answer] if random.random() < 0.9 else []
            kinds += random.choices((pulse, burst), (4, 1), k=random.choice((1, 1, 2, 3)))
            for kind in kinds[:1] if random.random() < calm else kinds:
                for name, ticks in kind(config, random).items():
                    toggles[name] += [begin + tick for tick in ticks]
        origin = stop + random.choice((1, 1, 2, 9))
        toggles["rst"] += [stop, origin]
    waves = {name: toggling(ticks, end) for name, ticks in toggles.items()}
    return Trace(waves, Fraction(1, config.clock_hz), 0, end)
