"""What drives a position link in the tests: configurations of short cycles, and lines of any kind.

A cycle of the smallest lasts some 400 ticks.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from random import Random
from typing import Any

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from railgate.position_link.spec import CRC16, EVEN, ODD, Check, Config, Edge
from railgate.waves import Trace, Waveform

Levels = dict[str, NDArray[np.uint8]]

CLOCK_HZ = 10_000
CYCLES = 6


def short(ticks_per_bit: Fraction, slack_bits: int = 0, **named: Any) -> Config:
    """A configuration whose cycle is not much longer than it has to be."""
    bits = max(named["word_bits"], named.get("request_bits", Config.request_bits) + 1)
    while True:
        ticks = round(bits * ticks_per_bit)
        rate = Fraction(bits * CLOCK_HZ, ticks)
        cycle_s = Fraction(ticks, CLOCK_HZ)
        try:
            Config(clock_hz=CLOCK_HZ, bit_rate_hz=rate, cycle_s=cycle_s, **named)
        except ValueError as error:
            if "answer and frame" not in str(error) and "bit_rate_hz" not in str(error):
                raise
            bits += 1
        else:
            if not slack_bits:
                return Config(clock_hz=CLOCK_HZ, bit_rate_hz=rate, cycle_s=cycle_s, **named)
            bits, slack_bits = bits + slack_bits, 0


CHECKS = st.sampled_from((None, None, EVEN, ODD, CRC16, Check(width=3, polynomial=3, final=5)))


@st.composite
def configs(draw: st.DrawFn) -> Config:
    ticks_per_bit = draw(st.fractions(8, 26, max_denominator=60))
    half = int(ticks_per_bit * Fraction(97, 200))
    word_bits = draw(st.sampled_from((8, 9, 12, 17, 20, 63, 64, 65, 80)))
    check = draw(CHECKS)
    timeout = draw(st.integers(1, 6))
    return short(
        max(ticks_per_bit, Fraction(33, 4)),
        draw(st.integers(0, 4)),
        request_bits=draw(st.integers(1, 5)),
        timeout_bits=timeout,
        timeout_from_end=draw(st.booleans()),
        earliest_clk=draw(st.integers(1, timeout)),
        word_bits=word_bits,
        sampling_edge=draw(st.sampled_from(Edge)),
        fault_word=draw(st.sampled_from((None, 0, 0x5A))),
        zero_is_fault=draw(st.booleans()),
        check=check if check and check.width < word_bits else None,
        tolerated_cycles=draw(st.integers(1, 3)),
        recovery_cycles=draw(st.integers(1, 3)),
        filter_ticks=draw(st.integers(0, min(half - 1, 8))),
        guard_ticks=draw(st.integers(0, (half - 1) // 2)),
        bare=draw(st.booleans()),
        count_bits=8,
        age_bits=draw(st.integers(2, 3)),
        age_ticks_bits=16,
    )


@dataclass(frozen=True)
class Answer:
    """One answer: the CLK of its cycle with which UEF rises, so many CLK too long, so many ticks
    off at either end; the word, and how late DATA is, in ticks."""

    clk: int
    word: int
    longer: int = 0
    rise: int = 0
    fall: int = 0
    late: int = 0


def draw_answer(
    config: Config, levels: Levels, cycle: int, answer: Answer, origin: int = 0
) -> None:
    """Put an answer into the levels of `uef` and `data`, tick by tick."""
    begin = origin + 1 + cycle * config.cycle_ticks
    at = [begin + config.rise(answer.clk + n) for n in range(config.word_bits + 1)]
    end = begin + config.rise(answer.clk + config.word_bits + answer.longer)
    levels["uef"][max(at[0] + answer.rise, 0) : max(end + answer.fall, 0)] ^= 1
    for n in range(config.word_bits):
        bit = answer.word >> (config.word_bits - 1 - n) & 1
        levels["data"][max(at[n] + answer.late, 0) : max(at[n + 1] + answer.late, 0)] = bit


def good_word(config: Config, payload: int) -> int:
    """A word that passes the check."""
    check = config.check
    if not check:
        return payload % (1 << config.word_bits)
    count = config.word_bits - check.width
    payload %= 1 << count
    return payload << check.width | check.of(payload, count)


def trace(config: Config, levels: Levels) -> Trace:
    """A stimulus of levels, tick by tick."""
    ticks = np.arange(levels["uef"].size)
    waves = {name: Waveform.of(ticks, values) for name, values in levels.items()}
    return Trace(waves, Fraction(1, config.clock_hz), 0, ticks.size)


def quiet(config: Config, cycles: int) -> Levels:
    """Levels of lines on which nothing happens."""
    return {
        name: np.zeros(cycles * config.cycle_ticks, np.uint8) for name in ("uef", "data", "rst")
    }


def random_answer(config: Config, random: Random) -> Answer:
    """Good in two of three cases, else with one thing or another wrong, most often by little."""
    low, high = config.earliest_clk - 1, config.window_bits - 1
    word = good_word(config, random.getrandbits(config.word_bits))
    late = config.rise(1) // 2 if config.sampling_edge is Edge.RISING else 0
    answer = Answer(random.randint(low, high), word, late=late)
    wrong: tuple[dict[str, int], ...] = (
        {"clk": random.randint(0, high + 2)},
        {"word": random.choice((0, config.invalid_word, word ^ 1, random.getrandbits(8)))},
        {"longer": random.choice((-1, 1, random.randint(-config.word_bits, 400)))},
        {"rise": random.randint(-12, 12), "fall": random.randint(-12, 12)},
        {"late": late + random.randint(-12, 12)},
    )
    for change in random.sample(wrong, random.choice((0, 0, 0, 0, 1, 2))):
        answer = replace(answer, **change)
    return answer


def noise(config: Config, random: Random, levels: Levels) -> None:
    """Glitches of any length on both lines."""
    for _ in range(random.choice((0, 0, 0, 1, 3, 12))):
        name, at = random.choice(("uef", "data")), random.randrange(levels["uef"].size)
        levels[name][at : at + random.randint(1, 2 * config.filter_ticks + 3)] ^= 1


@st.composite
def stimuli(draw: st.DrawFn, of: st.SearchStrategy[Config] | None = None) -> tuple[Config, Trace]:
    """A configuration and a line: answers good and bad, noise, resets."""
    config = draw(configs() if of is None else of)
    levels = quiet(config, draw(st.integers(2, CYCLES)))
    random = Random(draw(st.integers(0, 1 << 32)))
    size, origin = levels["uef"].size, 0
    levels["uef"] ^= random.choice((0, 0, 0, 0, 0, 0, 0, 0, 1))
    levels["data"] ^= random.choice((0, 1))
    for _ in range(random.choice((0, 0, 0, 1, 2))):
        at, length = random.randrange(size), random.randint(1, 5)
        levels["rst"][at : at + length], origin = 1, at + length
    for cycle in range(size // config.cycle_ticks):
        for _ in range(random.choice((0, *[1] * 12, 2))):
            draw_answer(config, levels, cycle, random_answer(config, random), origin)
    noise(config, random, levels)
    return config, trace(config, levels)
