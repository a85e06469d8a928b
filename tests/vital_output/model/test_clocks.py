"""Clock edges are exact, as far as ticks go."""

from fractions import Fraction
from math import ceil, floor

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from railgate.engines import Clock
from railgate.engines.signals import LAST_TICK
from railgate.vital_output.model.clocks import clock_of, edge, ticks_of

FS = Fraction(1, 10**15)
CLOCKS = st.builds(
    Clock,
    frequency_hz=st.integers(1_000, 10**9).map(Fraction),
    ppm=st.fractions(-100, 100, max_denominator=1000),
    phase=st.fractions(0, Fraction(999, 1000), max_denominator=1000),
)


@given(CLOCKS, st.fractions(0, 1, max_denominator=1 << 20))
@settings(deadline=None)
def test_edges_are_where_the_engines_have_them(clock: Clock, part: Fraction) -> None:
    period = clock.period / FS
    assume(period.denominator * (period * clock.phase).denominator < 1 << 58)
    known = clock_of(clock, FS)
    n = floor(part * (LAST_TICK / period - 2))
    expected = ceil((n + 1 + clock.phase) * period)
    assert edge(known[0], n) == expected
    times = np.array([expected - 1, expected])
    assert ticks_of(known, times).tolist() == [n, n + 1]


def test_a_tick_without_phase_is_an_edge() -> None:
    clock = Clock(frequency_hz=Fraction(16_000_000))
    known = clock_of(clock, clock.period)
    assert [edge(known[0], n) for n in (0, 1, 10**15)] == [1, 2, 10**15 + 1]
    assert ticks_of(known, np.array([0, 1, 10**15])).tolist() == [0, 1, 10**15]


def test_what_64_bits_do_not_hold_is_an_error() -> None:
    with pytest.raises(ValueError, match="must be whole numbers of 1/d tick with a d below 2⁵⁸"):
        clock_of(Clock(frequency_hz=Fraction(1), phase=Fraction(1, 3**38)), FS)
