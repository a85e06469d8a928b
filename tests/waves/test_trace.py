"""Trace against dictionaries from tick to value, and its time base at 64 bits."""

import math
import re
import time
import tracemalloc
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from railgate.waves import Difference, Trace, Waveform
from railgate.waves.trace import rescale

US = Fraction(1, 1_000_000)
LOW, HIGH = -(1 << 63), (1 << 63) - 1
periods = st.fractions(Fraction(1, 50), 50, max_denominator=60).filter(bool)


@st.composite
def traces(draw, names="ab", start=None, period=US, min_ticks=1):
    """(trace, {name: {tick: value}})."""
    first = draw(st.integers(-20, 20)) if start is None else start
    ticks = range(first, first + draw(st.integers(min_ticks, 25)))
    model = {name: {t: draw(st.integers(0, 3)) for t in ticks} for name in names}
    signals = {n: Waveform.of(list(of), list(of.values()), 2) for n, of in model.items()}
    return Trace(signals, period, first, ticks.stop), model


def held(trace: Trace) -> dict[str, dict[int, int]]:
    ticks = range(trace.start, trace.end)
    return {
        name: dict(zip(ticks, wave.at(ticks).tolist(), strict=True))
        for name, wave in trace.signals.items()
    }


@given(
    st.lists(st.integers(LOW, HIGH), min_size=1, max_size=8),
    st.one_of(st.integers(1, 1 << 62), st.integers(1, 1 << 70)),
    st.one_of(st.integers(1, 1 << 31), st.integers(1, 1 << 70)),
)
def test_rescale_is_exact_or_refuses(ticks, up, down):
    ticks.sort()
    ratio = Fraction(up, down)
    expected = [math.ceil(tick * ratio) for tick in ticks]
    if expected[0] >= LOW and expected[-1] <= HIGH:
        assert rescale(np.array(ticks), ratio).tolist() == expected
    else:
        with pytest.raises(ValueError, match="leaves 64 bits"):
            rescale(np.array(ticks), ratio)


@pytest.mark.parametrize("tick", [LOW, -1, 0, 1, HIGH])
def test_rescale_reaches_both_ends_of_64_bits(tick):
    assert rescale(np.array([tick]), Fraction(1)).tolist() == [tick]
    assert rescale(np.array([tick]), Fraction(1, 3)).tolist() == [math.ceil(Fraction(tick, 3))]


def test_rescale_takes_a_clock_with_a_ppm_offset_to_femtoseconds():
    ratio = 10**15 / (Fraction(16_000_000) * Fraction(1_000_013, 1_000_000))
    ticks = [0, 1, 16_000_000, 10**11]
    assert rescale(np.array(ticks), ratio).tolist() == [math.ceil(t * ratio) for t in ticks]


@given(traces(), periods)
def test_a_sampler_sees_the_value_of_its_time(case, ratio):
    trace, model = case
    period = US * ratio
    seen = trace.resample(period)
    assert seen.period == period
    ticks = [j for j in range(-1500, 3000) if trace.start <= j * ratio < trace.end]
    assume(ticks)
    assert (seen.start, seen.end) == (ticks[0], ticks[-1] + 1)
    for name, of in model.items():
        expected = [of[math.floor(j * ratio)] for j in ticks]
        assert seen[name].at(ticks).tolist() == expected


@given(traces(), st.data())
def test_a_slice_holds_what_the_whole_held(case, data):
    trace, model = case
    start = data.draw(st.integers(trace.start, trace.end))
    end = data.draw(st.integers(start, trace.end))
    part = trace.slice(start, end)
    assert (part.start, part.end) == (start, end)
    assert held(part) == {n: {t: of[t] for t in range(start, end)} for n, of in model.items()}


@given(traces(), st.data())
def test_two_slices_together_are_the_whole(case, data):
    trace, _ = case
    cut = data.draw(st.integers(trace.start, trace.end))
    assert trace.slice(trace.start, cut).concatenate(trace.slice(cut, trace.end)) == trace


@given(traces(start=0), st.data())
def test_one_trace_after_another_holds_both(case, data):
    trace, model = case
    then, its = data.draw(traces(start=trace.end))
    assert held(trace.concatenate(then)) == {n: model[n] | its[n] for n in model}


@given(traces(), st.integers(-1000, 1000))
def test_a_shift_moves_every_tick(case, by):
    trace, model = case
    assert held(trace.shift(by)) == {
        n: {t + by: v for t, v in of.items()} for n, of in model.items()
    }


@given(traces(), st.integers(-30, 60))
def test_an_extension_holds_the_last_value(case, end):
    trace, model = case
    longer = trace.extend(end)
    assert longer.end == max(end, trace.end)
    for name, of in model.items():
        assert held(longer)[name] == {
            t: of.get(t, of[trace.end - 1]) for t in range(trace.start, longer.end)
        }


@given(traces(start=0), traces(start=0))
def test_the_first_difference_is_the_earliest(one, other):
    (left, mine), (right, its) = one, other
    both = range(min(left.end, right.end))
    at = next((t for t in both if any(mine[n][t] != its[n][t] for n in mine)), None)
    if at is None and left.end != right.end:
        assert left.first_difference(right) == Difference(
            "the end", min(left.end, right.end), left.end, right.end
        )
    elif at is None:
        assert left.first_difference(right) is None
    else:
        found = left.first_difference(right)
        assert found.tick == at
        assert (found.left, found.right) == (mine[found.signal][at], its[found.signal][at])
        assert found.left != found.right
    assert (left == right) == (left.first_difference(right) is None)


def test_a_missing_signal_and_another_start_are_differences():
    one = Trace({"a": Waveform.of([0], [1])}, US, 0, 5)
    assert one.first_difference(Trace({}, US, 0, 5)) == Difference("a", 0, 1, None)
    assert Trace({}, US, 0, 5).first_difference(one) == Difference("a", 0, None, 1)
    later = Trace({"a": Waveform.of([2], [1])}, US, 2, 5)
    assert one.first_difference(later) == Difference("a", 0, 1, None)
    empty = Trace({}, US, 0, 5).first_difference(Trace({}, US, 2, 5))
    assert str(empty) == "the start at tick 0: 0 against 2"
    with pytest.raises(ValueError, match="cannot be compared"):
        one.first_difference(Trace({}, 2 * US, 0, 5))


def test_equality_counts_time_base_width_and_sign():
    def trace(period=US, **kind):
        return Trace({"a": Waveform.of([0], [1], **{"width": 2, **kind})}, period, 0, 5)

    assert trace() == trace()
    assert trace() != trace(2 * US)
    assert trace() != trace(width=3)
    assert trace() != trace(signed=True)
    assert trace() != "a trace"


def test_signals_are_selected_renamed_and_merged():
    a, b = Waveform.of([0], [1]), Waveform.of([0, 3], [0, 1])
    trace = Trace({"a": a, "b": b}, US, 0, 5)
    assert list(trace.select(["b", "a"]).signals) == ["b", "a"]
    assert trace.rename({"a": "b", "b": "a"}).signals == {"b": a, "a": b}
    assert trace.select(["a"]).merge(trace.select(["b"])) == trace
    assert trace.duration_s == 5 * US


def test_misuse_is_refused_in_one_line():
    a, b = Waveform.of([0], [1]), Waveform.of([0, 3], [0, 1])
    trace = Trace({"a": a, "b": b}, US, 0, 5)
    for misuse, reason in [
        (lambda: trace["c"], 'no channel "c"; there are: a, b'),
        (lambda: trace.rename({"c": "d"}), 'no channel "c"'),
        (lambda: trace.rename({"a": "b"}), 'not be two of "b"'),
        (lambda: trace.merge(trace), "both traces have the signals a, b"),
        (lambda: trace.merge(trace.shift(1)), "one time base and span"),
        (lambda: trace.slice(3, 6), "must lie inside ticks 0..5, not 3..6"),
        (lambda: trace.concatenate(trace), "must begin at tick 5"),
        (lambda: trace.concatenate(trace.shift(5).select("a")), "only one has: b"),
        (
            lambda: trace.concatenate(
                Trace({"a": a, "b": Waveform.of([0], [3], 2)}, US, 0, 5).shift(5)
            ),
            '"b" must keep its width of 1 bits',
        ),
        (lambda: Trace({}, Fraction(0), 0, 5), "must be above 0 s, not 0"),
        (lambda: Trace({}, US, 5, 4), "must not end before its start"),
        (lambda: Trace({}, US, 0, 1 << 63), "must fit 64 bits, not 0..9223372036854775808"),
        (lambda: Trace({"a": a}, US, 1, 4), "begin at the trace's start, tick 1, not 0"),
        (lambda: Trace({"b": b}, US, 0, 3), "end before the trace's end, tick 3, not 3"),
    ]:
        with pytest.raises(ValueError, match=re.escape(reason)):
            misuse()


@pytest.mark.parametrize("down", [16_000_208, (1 << 61) - 1])
def test_rescale_of_many_ticks_takes_little_memory(down):
    ratio = Fraction(10**15, down)
    ticks = np.arange(1 << 18)
    tracemalloc.start()
    scaled = rescale(ticks, ratio)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 16 << 20
    for tick in (0, 1, 65_535, 65_536, 262_143):
        assert scaled[tick] == math.ceil(tick * ratio)


def test_a_period_that_no_tick_reaches_is_refused():
    trace = Trace({"a": Waveform.of([0, 3], [0, 1])}, Fraction(1), 0, 5)
    with pytest.raises(ValueError, match="leaves 64 bits"):
        trace.resample(Fraction(1, 1 << 62))


@given(st.tuples(st.integers(1, 64), st.booleans()), st.tuples(st.integers(1, 64), st.booleans()))
def test_another_width_or_sign_is_a_difference(one, other):
    left, right = (Trace({"a": Waveform.of([3], [0], *kind)}, US, 3, 9) for kind in (one, other))
    found = left.first_difference(right)
    assert (left == right) == (found is None)
    if one[0] != other[0]:
        assert str(found) == f"the width of a at tick 3: {one[0]} against {other[0]}"
    elif one != other:
        assert found == Difference("the sign of a", 3, int(one[1]), int(other[1]))


def test_renaming_many_signals_takes_linear_time():
    wave = Waveform.of([0], [0])
    trace = Trace({f"s{index}": wave for index in range(20_000)}, US, 0, 5)
    began = time.process_time()
    with pytest.raises(ValueError, match='not be two of "s19998"'):
        trace.rename({"s19999": "s19998"})
    assert time.process_time() - began < 1
