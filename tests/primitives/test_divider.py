"""The fractional divider, against the ticks of its definition."""

from fractions import Fraction
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.engines import Clock, Design
from railgate.engines.pysim import PySim
from railgate.primitives import FractionalDivider
from railgate.waves import Trace

pytestmark = pytest.mark.shows("LNK-1")


def strobes(end, *arguments):
    """The ticks below `end` in which it strobes."""
    design = Design(
        name="divider",
        component=lambda: FractionalDivider(*arguments),
        clocks=(Clock(frequency_hz=Fraction(1)),),
    )
    strobe = PySim(design).advance(end, Trace({}, Fraction(1), 0, end))["strobe"]
    return [tick for tick in range(end) if strobe.at(tick)]


def expected(end, numerator, denominator, delay=0):
    ticks = (delay - -n * denominator // numerator for n in range(end * numerator))
    return [tick for tick in ticks if tick < end]


def test_8_strobes_of_512_khz_are_625_ticks_of_40_mhz_and_never_a_tick_off():
    ticks = strobes(1875, 8, 625)
    assert ticks == [-(-n * 625 // 8) for n in range(24)]
    assert {b - a for a, b in pairwise(ticks)} == {78, 79}


@pytest.mark.parametrize("ratio", [(1, 1), (1, 8), (1, 7), (2, 3), (16, 625), (5, 5)])
def test_the_delay_moves_all_strobes_and_none_comes_before_it(ratio):
    for delay in (0, 1, 2, 9, 100):
        assert strobes(250, *ratio, delay) == expected(250, *ratio, delay)


@pytest.mark.parametrize("ratio", [(1, 8), (1, 7), (2, 9), (3, 20), (16, 625)])
def test_strobe_0_is_over_before_tick_0_where_the_delay_is_negative(ratio):
    for delay in (-1, -2, -4):
        assert strobes(250, *ratio, delay) == expected(250, *ratio, delay)[1:]


@settings(max_examples=40, deadline=None)
@given(st.integers(1, 60), st.integers(0, 80), st.integers(0, 30))
def test_every_strobe_is_in_the_tick_of_its_number(numerator, more, delay):
    ratio = numerator, numerator + more
    assert strobes(120, *ratio, delay) == expected(120, *ratio, delay)
