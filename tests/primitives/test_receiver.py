"""The serial receiver, against its sampling ticks written out."""

from fractions import Fraction
from functools import cache

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.engines import Clock, Design
from railgate.engines.pysim import PySim
from railgate.primitives import SerialReceiver
from railgate.waves import Trace, Waveform

EVENTS = ("starts", "false_start", "bit", "done")


@cache
def opened(bit_ticks, bits):
    clock = Clock(frequency_hz=Fraction(1))
    component = lambda: SerialReceiver(bit_ticks, bits)  # noqa: E731
    engine = PySim(Design(name="receiver", component=component, clocks=(clock,)))
    return engine, engine.checkpoint()


def run(bit_ticks, bits, falls, levels):
    """The outputs; a level in each tick, and the ticks told as falls of it."""
    engine, start = opened(bit_ticks, bits)
    engine.restore(start)
    end = len(levels)
    waves = {
        "level": Waveform.of(range(end), levels),
        "fall": Waveform.of(range(end), [int(tick in falls) for tick in range(end)]),
    }
    return engine.advance(end, Trace(waves, Fraction(1), 0, end))


def high(result, name):
    return [tick for tick in range(result.end) if result[name].at(tick)]


@pytest.mark.parametrize(
    ("bit_ticks", "samples"),
    [
        (2, [11, 13, 15, 17, 19]),
        (5, [12, 17, 22, 27, 32]),
        (8, [14, 22, 30, 38, 46]),
    ],
)
def test_each_bit_is_sampled_in_its_tick_and_in_no_other(bit_ticks, samples):
    bits = [0, 1, 0, 0, 1]
    levels = [1] * 60
    for tick, bit in zip(samples, bits, strict=True):
        levels[tick] = bit
        levels[tick + 1] = 1 - bit
    result = run(bit_ticks, 5, {10}, levels)
    assert high(result, "starts") == samples[:1]
    assert high(result, "bit") == samples[1:]
    assert [result["data"].at(tick) for tick in samples[1:]] == bits[1:]
    assert high(result, "done") == [samples[-1] + 1]
    assert high(result, "false_start") == []
    assert result["word"].at(samples[-1] + 1) == 0b1001
    assert result["word"].ticks.max() == samples[-1] + 1


def test_a_start_bit_that_is_none_ends_it_and_another_may_begin_in_the_next_tick():
    levels = [0 if 15 <= tick < 40 else 1 for tick in range(60)]
    result = run(8, 3, {10, 15}, levels)
    assert high(result, "false_start") == [14]
    assert high(result, "starts") == [19]
    assert high(result, "bit") == [27, 35]
    assert high(result, "done") == [36]


@pytest.mark.parametrize(("fall", "seen"), [(29, False), (30, False), (31, True), (32, True)])
def test_the_next_begins_from_the_tick_of_done_on(fall, seen):
    result = run(8, 3, {10, fall}, [0] * 80)
    assert high(result, "done") == [31] + [fall + 21] * seen
    assert high(result, "starts") == [14] + [fall + 4] * seen


def reference(bit_ticks, bits, falls, levels):
    """The ticks of each event, and the words told with `done`, by the sentences of the contract."""
    events = {name: [] for name in EVENTS}
    words = []
    free = 0
    for fall in sorted(falls):
        if fall < free:
            continue
        samples = [fall + j * bit_ticks + bit_ticks // 2 for j in range(bits)]
        seen = [tick for tick in samples if tick < len(levels)]
        if seen and levels[seen[0]]:
            events["false_start"].append(seen[0])
            free = seen[0] + 1
            continue
        events["starts"] += seen[:1]
        events["bit"] += seen[1:]
        free = samples[-1] + 1
        if free < len(levels):
            events["done"].append(free)
            words.append(int("".join(str(levels[tick]) for tick in samples[1:]), 2))
    return events, words


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from([(2, 2), (4, 3), (5, 9), (3, 70)]),
    st.sets(st.integers(0, 299), max_size=60),
    st.lists(st.integers(0, 1), min_size=300, max_size=300),
)
def test_whatever_the_line_does_it_reads_what_its_contract_says(shape, falls, levels):
    result = run(*shape, falls, levels)
    events, words = reference(*shape, falls, levels)
    assert {name: high(result, name) for name in EVENTS} == events
    parts = [name for name in result.signals if name.startswith("word")]
    told = [
        sum(int(result[name].at(tick)) << 64 * place for place, name in enumerate(parts))
        for tick in events["done"]
    ]
    assert told == words
