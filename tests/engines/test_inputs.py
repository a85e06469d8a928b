"""Pins over a span of ticks, in whatever pieces it is taken."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.engines.inputs import NO_TICKS, Filter, Input, filtered, stretches
from railgate.waves import Waveform

LEVELS = st.lists(st.integers(0, 1), min_size=1, max_size=60)


def pin(levels: list[int]) -> Waveform:
    return Waveform.of(range(len(levels)), levels)


@settings(deadline=None)
@given(LEVELS, st.integers(0, 5), st.lists(st.integers(0, 60), max_size=5))
def test_a_filter_passes_levels_that_last_in_whatever_pieces(
    levels: list[int], filter_ticks: int, cuts: list[int]
) -> None:
    level, held, passed, rejected = levels[0], 0, [], []
    for tick, now in enumerate(levels):
        if now == level and held:
            rejected.append(tick + 2)
        held = held + 1 if now != level else 0
        if held > filter_ticks:
            passed.append(tick - filter_ticks)
            level, held = now, 0
    taken, start = Filter(filter_ticks, level=levels[0]), 0
    edges, glitches = [], []
    for end in sorted({*(cut for cut in cuts if cut < len(levels)), len(levels)}):
        if end > start:
            of_part = taken.take(Input.of(pin(levels), start, end), start, end)
            edges += of_part[0].tolist()
            glitches += of_part[1].tolist()
            start = end
    assert (edges, glitches) == (passed, rejected)


def test_a_change_is_decided_once_it_has_lasted() -> None:
    pins = np.array([10], np.int64)
    assert filtered(pins, 4, 14)[2] == 0
    assert filtered(pins, 4, 15)[2] == 1


@pytest.mark.parametrize(
    ("rst", "want"),
    [
        (Input(0, NO_TICKS), [(20, None)]),
        (Input(0, np.array([5, 8])), [(6, 8), (20, None)]),
        (Input(1, np.array([3])), [(1, 3), (20, None)]),
        (Input(0, np.array([19])), [(20, 20)]),
    ],
)
def test_a_reset_parts_a_span_into_stretches(
    rst: Input, want: list[tuple[int, int | None]]
) -> None:
    assert list(stretches(rst, 0, 20)) == want
