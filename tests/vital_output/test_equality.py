"""One channel: gateware and model are the same, tick for tick (SYS-2)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import partial

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.engines import Design, open_engine
from railgate.vital_output.design import design
from railgate.vital_output.spec import Config
from railgate.waves import Trace
from vital_output.equality import assert_same, opened
from vital_output.random_channel import surroundings
from vital_output.small import SMALL

pytestmark = pytest.mark.shows("SYS-2")

SEEDS = st.integers(0, 1 << 32)
WIDE = replace(
    SMALL,
    outputs=9,
    cycle_s=Fraction(24, 1000),
    tau0_s=Fraction(11, 1000),
    tau1_s=Fraction(12, 1000),
    delay_cycles=1,
    life_cycles=2,
    spare_messages=1,
    lost_messages=3,
    polynomial=0x04C1_1DB7,
    error_interval_s=Fraction(1, 10),
    zero_at_once=True,
    link_filter_ticks=1,
    feedback_filter_ticks=0,
    release_min_s=Fraction(11, 1000),
    release_s=Fraction(12, 1000),
    holdover_cycles=3,
    bit_ticks=5,
)
DESIGNS: tuple[tuple[Config, int], ...] = ((SMALL, 0), (SMALL, 1), (WIDE, 0), (WIDE, 1))
MADE: dict[tuple[int, int], Callable[[], Design]] = {
    (id(config), board): partial(design, config, board) for config, board in DESIGNS
}


def assert_channel_is_the_same(config: Config, board: int, cycles: int, seed: int) -> Trace:
    """The compiled gateware makes its own surroundings; the model is given the same."""
    made = MADE[id(config), board]
    inputs = surroundings(config, board, cycles, seed, opened(made, "cxxrtl"))
    found = opened(made, "cxxrtl").advance(inputs.end, inputs)
    assert_same(open_engine(made(), "leap").advance(inputs.end, inputs), found, board, seed)
    return found


@given(st.sampled_from(DESIGNS), SEEDS)
@settings(max_examples=10, deadline=None)
def test_the_channel_is_that_of_leap_whatever_surrounds_it(
    of: tuple[Config, int], seed: int
) -> None:
    assert_channel_is_the_same(*of, 8, seed)


@given(st.sampled_from(DESIGNS[:2]), SEEDS)
@settings(max_examples=2, deadline=None)
def test_the_channel_of_pysim_is_that_of_leap(of: tuple[Config, int], seed: int) -> None:
    made = MADE[id(of[0]), of[1]]
    inputs = surroundings(*of, 2, seed, opened(made, "cxxrtl"))
    found = open_engine(made(), "pysim").advance(inputs.end, inputs)
    assert_same(open_engine(made(), "leap").advance(inputs.end, inputs), found, seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(400))
def test_the_channel_is_that_of_leap_for_long(seed: int) -> None:
    assert_channel_is_the_same(*DESIGNS[seed % len(DESIGNS)], 40, seed)
