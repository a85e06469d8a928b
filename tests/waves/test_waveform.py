"""Waveform against the plainest model there is: a dictionary from tick to value."""

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from railgate.waves import Waveform
from railgate.waves.waveform import storage

SPAN = 30


@st.composite
def sampled(draw, start=None, min_size=1):
    """(waveform, {tick: value}) of a signal known at every tick of a short span."""
    width = draw(st.sampled_from([1, 2, 8, 33, 64]))
    signed = draw(st.booleans())
    low, high = (-(1 << width - 1), (1 << width - 1) - 1) if signed else (0, (1 << width) - 1)
    few = st.one_of(st.sampled_from([low, high]), st.integers(low, high))
    first = draw(st.integers(-20, 20)) if start is None else start
    values = draw(st.lists(few, min_size=min_size, max_size=SPAN))
    ticks = range(first, first + len(values))
    return Waveform.of(ticks, values, width, signed), dict(zip(ticks, values, strict=True))


@given(sampled())
def test_every_tick_holds_its_value(case):
    wave, model = case
    assert wave.at(list(model)).tolist() == list(model.values())
    assert wave.values.dtype == storage(wave.width, wave.signed)


@given(sampled())
def test_a_waveform_holds_one_step_for_each_change(case):
    wave, model = case
    changes = [t for t in model if t - 1 not in model or model[t] != model[t - 1]]
    assert wave.ticks.tolist() == changes


@given(sampled())
def test_edges_are_where_zero_is_left_and_reached(case):
    wave, model = case
    inner = [t for t in model if t - 1 in model]
    assert wave.rising().tolist() == [t for t in inner if model[t] and not model[t - 1]]
    assert wave.falling().tolist() == [t for t in inner if not model[t] and model[t - 1]]


@given(sampled(), st.data())
def test_a_slice_holds_what_the_whole_held(case, data):
    wave, model = case
    start = data.draw(st.sampled_from(list(model)))
    end = data.draw(st.integers(start + 1, max(model) + 1))
    part = wave.slice(start, end)
    assert part.ticks[0] == start
    assert part.ticks[-1] < end
    assert part.at(range(start, end)).tolist() == [model[t] for t in range(start, end)]


@given(sampled(), st.integers(-(10**12), 10**12))
def test_a_shift_moves_every_value(case, by):
    wave, model = case
    later = wave.shift(by)
    assert later.at([t + by for t in model]).tolist() == list(model.values())


@given(sampled(start=0), sampled(start=0))
def test_the_first_difference_is_the_first(one, other):
    (left, mine), (right, its) = one, other
    ends = max(len(mine), len(its))
    held = [(mine.get(t, mine[len(mine) - 1]), its.get(t, its[len(its) - 1])) for t in range(ends)]
    expected = next((t for t, (a, b) in enumerate(held) if a != b), None)
    assert left.first_difference(right) == expected
    assert right.first_difference(left) == expected


def test_a_later_beginning_is_a_difference_of_the_earlier():
    assert Waveform.of([3], [0]).first_difference(Waveform.of([5], [0])) == 3


@given(st.lists(st.tuples(st.integers(0, 9), st.integers(0, 3)), min_size=1))
def test_of_equal_ticks_the_last_counts(pairs):
    pairs.sort(key=lambda pair: pair[0])
    wave = Waveform.of([t for t, _ in pairs], [v for _, v in pairs], 2)
    held = dict(pairs)
    assert wave.at(list(held)).tolist() == list(held.values())


def test_equality_counts_width_and_sign():
    wave = Waveform.of([0, 5], [0, 1], 8)
    assert wave == Waveform.of([0, 5, 7], [0, 1, 1], 8)
    assert wave != Waveform.of([0, 5], [0, 1], 7)
    assert wave != Waveform.of([0, 5], [0, 1], 8, signed=True)
    assert wave != "a waveform"
    assert len(wave) == 2


@pytest.mark.parametrize(
    ("width", "signed", "value", "reason"),
    [
        (1, False, 2, "between 0 and 1, not 2"),
        (3, False, 8, "between 0 and 7, not 8"),
        (8, False, 256, "between 0 and 255, not 256"),
        (8, False, -1, "between 0 and 255, not -1"),
        (4, True, 8, "between -8 and 7, not 8"),
        (64, False, 1 << 64, "between 0 and 18446744073709551615, not 18446744073709551616"),
        (64, True, 1 << 63, "not 9223372036854775808"),
        (8, False, 1.5, "must be integers, not float64"),
        (0, False, 0, "between 1 and 64 bits, not 0"),
        (65, False, 0, "between 1 and 64 bits, not 65"),
    ],
)
def test_values_that_do_not_fit_are_refused(width, signed, value, reason):
    with pytest.raises(ValueError, match=reason):
        Waveform.of([0], [value], width, signed)
    with pytest.raises(ValueError, match=reason):
        Waveform(np.array([0]), np.array([value]), width, signed)


@pytest.mark.parametrize(
    ("ticks", "values", "reason"),
    [
        ([], [], "at least one"),
        ([0, 1], [0], "as many values as ticks"),
        ([[0]], [[0]], "as many values as ticks"),
        ([0, 2, 2], [0, 1, 0], "must rise strictly, not go from 2 to 2"),
        ([0, 5, 4], [0, 1, 0], "must rise strictly, not go from 5 to 4"),
        ([0, 1, 7], [0, 1, 1], "not repeat at tick 7"),
    ],
)
def test_what_is_no_step_function_is_refused(ticks, values, reason):
    with pytest.raises(ValueError, match=re.escape(reason)):
        Waveform(np.array(ticks, np.int64), np.array(values, np.uint8))


def test_nothing_is_known_before_the_beginning():
    with pytest.raises(ValueError, match="begins at tick 5"):
        Waveform.of([5], [0]).at([4])


@pytest.mark.parametrize(
    ("ticks", "reason"),
    [
        ([0.5], "ticks must be integers of 64 bits, not float64"),
        ([True], "ticks must be integers of 64 bits, not bool"),
        (["7"], "ticks must be integers of 64 bits, not <U1"),
        ([1 << 63], "ticks must be at most 9223372036854775807, not 9223372036854775808"),
        ([1 << 64], "ticks must be integers of 64 bits, not object"),
    ],
)
def test_ticks_are_integers_of_64_bits(ticks, reason):
    for make in (Waveform, Waveform.of):
        with pytest.raises(ValueError, match=reason):
            make(np.array(ticks), np.array([1]))


def test_ticks_of_other_integer_types_are_taken():
    for kind in (np.uint8, np.int32, np.uint64):
        assert Waveform(np.array([1, 9], kind), np.array([0, 1])).ticks.dtype == np.int64


def test_a_slice_before_the_beginning_is_refused():
    wave = Waveform.of([20], [1])
    for end in (10, 20):
        with pytest.raises(ValueError, match=f"begins at tick 20, not before {end}"):
            wave.slice(0, end)
    assert wave.slice(0, 21) == wave.slice(20, 20) == wave
