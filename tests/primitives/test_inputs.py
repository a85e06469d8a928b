"""Synchroniser and glitch filter, against the filter's definition and by name."""

from fractions import Fraction
from functools import cache
from itertools import accumulate

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.engines import Clock, Design
from railgate.engines.pysim import PySim
from railgate.primitives import FilteredInput
from railgate.waves import Trace, Waveform

pytestmark = pytest.mark.shows("ODO-9")


@cache
def opened(filter_ticks):
    clock = Clock(frequency_hz=Fraction(1_000_000))
    design = Design(name="input", component=lambda: FilteredInput(filter_ticks), clocks=(clock,))
    engine = PySim(design)
    return engine, engine.checkpoint()


def run(filter_ticks, end, toggles, initial=0):
    """The outputs over `end` ticks of a pin that toggles in the ticks given."""
    engine, start = opened(filter_ticks)
    engine.restore(start)
    ticks = [0, *(tick for tick in toggles if tick < end)]
    pin = Waveform.of(ticks, [(initial + i) % 2 for i in range(len(ticks))])
    return engine.advance(end, Trace({"pin": pin}, Fraction(1, 1_000_000), 0, end))


def high(wave, end):
    return [tick for tick in range(end) if wave.at(tick)]


def test_both_edges_come_three_ticks_and_the_filter_late():
    for filter_ticks in (0, 1, 7):
        result = run(filter_ticks, 80, [20, 40])
        late = 3 + filter_ticks
        assert result["level"] == Waveform.of([0, 20 + late, 40 + late], [0, 1, 0])
        assert high(result["rise"], 80) == [20 + late]
        assert high(result["fall"], 80) == [40 + late]
        assert high(result["glitch"], 80) == []


def test_a_level_held_too_short_is_rejected_and_told_when_it_is_gone():
    for length in range(1, 6):
        result = run(3, 60, [20, 20 + length])
        if length <= 3:
            assert high(result["glitch"], 60) == [20 + length + 2]
            assert high(result["level"], 60) == []
        else:
            assert high(result["glitch"], 60) == []
            assert len(high(result["level"], 60)) == length


def test_the_first_level_is_no_edge_and_comes_in_tick_3():
    for filter_ticks in (0, 5):
        for toggle in (1, 2, 3, 50):
            result = run(filter_ticks, 40, [toggle], initial=1)
            assert int(result["level"].ticks[1]) == 3
            assert high(result["rise"], 40) == []
            falls = [toggle + 3 + filter_ticks] if toggle < 50 else []
            assert high(result["fall"], 40) == falls


@settings(max_examples=40, deadline=None)
@given(
    st.sampled_from([0, 1, 4]),
    st.lists(st.integers(1, 9), max_size=30),
    st.integers(0, 1),
)
def test_the_filter_does_what_its_definition_says(filter_ticks, gaps, initial):
    """Tick by tick: f changes once s has held the other level for filter_ticks + 1 ticks."""
    end = 150
    result = run(filter_ticks, end, list(accumulate(gaps)), initial)
    toggles = list(accumulate(gaps))
    s = [(initial + sum(t <= k - 2 for t in toggles)) % 2 for k in range(end)]
    f = [0, 0, 0, s[2]]
    for k in range(3, end - 1):
        recent = range(k - filter_ticks, k + 1)
        stable = recent[0] >= 3 and all(s[j] != f[k] for j in recent)
        f.append(s[k] if stable else f[k])
    glitches = [k for k in range(4, end) if s[k] == f[k] == f[k - 1] and s[k - 1] != f[k - 1]]
    edges = [k for k in range(4, end) if f[k] != f[k - 1]]
    assert [int(result["level"].at(k)) for k in range(end)] == f
    assert high(result["glitch"], end) == glitches
    assert sorted(high(result["rise"], end) + high(result["fall"], end)) == edges
