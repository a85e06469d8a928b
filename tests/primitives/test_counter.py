"""Wide counter and sum in chunks, against the arithmetic that they are."""

from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.engines import Clock, Design
from railgate.engines.pysim import PySim
from railgate.primitives import ChunkedSum, LookaheadCounter
from railgate.waves import Trace, Waveform

pytestmark = pytest.mark.shows("SYS-3")


def opened(component):
    clock = Clock(frequency_hz=Fraction(1))
    return PySim(Design(name="counter", component=component, clocks=(clock,)))


def inputs(end, **waves):
    return Trace(waves, Fraction(1), 0, end)


def counted(modulus, start, gaps, marks=None):
    """The outputs of a counter at `start` that steps first in tick 6, then after each gap."""
    engine = opened(lambda: LookaheadCounter(modulus, marks))
    engine.poke("value", start)
    steps = [6]
    for gap in gaps:
        steps.append(steps[-1] + gap)
    ticks = sorted({0, *steps, *(step + 1 for step in steps)})
    wave = Waveform.of(ticks, [tick in steps for tick in ticks])
    return steps, engine.advance(steps[-1] + 4, inputs(steps[-1] + 4, step=wave))


@settings(max_examples=60, deadline=None)
@given(st.data(), st.integers(2, 1 << 40), st.lists(st.integers(3, 6), max_size=9))
def test_each_step_adds_one_modulo_any_modulus(data, modulus, gaps):
    near = st.sampled_from([0, modulus - 1, modulus // 2, (modulus - 1) & -16])
    start = (data.draw(near) - data.draw(st.integers(0, 6))) % modulus
    steps, result = counted(modulus, start, gaps)
    for number, step in enumerate(steps, 1):
        assert result["value"].at(step + 1) == (start + number) % modulus
    assert set(result["value"].ticks[1:].tolist()) <= {step + 1 for step in steps}


def test_a_mark_is_told_two_ticks_after_the_value_has_come_and_gone():
    steps, result = counted(20_480, 0x0FFE, [4, 4, 4], {"carried": 0x1000, "zero": 0})
    high = [tick for tick in range(steps[-1] + 4) if result["carried"].at(tick)]
    assert high == list(range(steps[1] + 3, steps[2] + 3))
    assert [result["zero"].at(tick) for tick in (0, 1, 2)] == [1, 1, 0]


@settings(max_examples=60, deadline=None)
@given(st.data(), st.integers(1, 40))
def test_the_sum_is_right_at_start_and_as_many_ticks_after_a_change_as_it_has_chunks(data, width):
    number = st.integers(0, (1 << width) - 1) | st.just((1 << width) - 1)
    addend = data.draw(number | st.integers(1 << width, 1 << width + 3))
    start, other = data.draw(number), data.draw(number)
    chunks = -(-width // 4)
    value = Waveform.of([0, 5], [start, other], width)
    engine = opened(lambda: ChunkedSum(width, addend, start))
    result = engine.advance(5 + chunks + 3, inputs(5 + chunks + 3, value=value))
    for first, last, term in ((0, 5, start), (5 + chunks, 5 + chunks + 2, other)):
        for tick in range(first, last + 1):
            assert result["total"].at(tick) == (term + addend) % (1 << width)
            assert result["overflow"].at(tick) == (term + addend >= 1 << width)
