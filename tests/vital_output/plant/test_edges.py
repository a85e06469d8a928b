"""The ticks of a clock are those in which an engine's registers change."""

from __future__ import annotations

from fractions import Fraction
from math import ceil

import numpy as np
import pytest
from amaranth.hdl import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import Out
from hypothesis import given
from hypothesis import strategies as st

from railgate.engines import Clock, Design, open_engine
from railgate.vital_output.plant.edges import FEMTOSECOND, Edges, femtoseconds
from railgate.waves import Trace, Waveform

clocks = st.builds(
    Clock,
    frequency_hz=st.sampled_from([Fraction(10**6), Fraction(16_000_000), Fraction(10**9, 7)]),
    ppm=st.fractions(-200, 200, max_denominator=1000),
    phase=st.fractions(0, Fraction(99, 100), max_denominator=100),
)


class Counter(wiring.Component):
    """Counts the ticks of its clock."""

    def __init__(self) -> None:
        super().__init__({"count": Out(16)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.d.sync += self.count.eq(self.count + 1)
        return m


def edge(clock: Clock, n: int) -> int:
    return ceil((n + 1 + clock.phase) * clock.period / FEMTOSECOND)


@given(clocks, st.lists(st.integers(0, 8 * 10**9), min_size=1))
def test_a_tick_lasts_from_edge_to_edge(clock: Clock, ticks: list[int]) -> None:
    edges = Edges(clock)
    assert edges.begin(ticks).tolist() == [edge(clock, n - 1) if n else 0 for n in ticks]
    ends = np.array([edge(clock, n) for n in ticks])
    for at in (edges.begin(ticks), ends - 1):
        assert edges.during(at).tolist() == ticks
    assert edges.first(ends - 1).tolist() == edges.first(ends).tolist() == [n + 1 for n in ticks]
    assert [edges.count(int(end)) for end in ends] == [n + 1 for n in ticks]


@pytest.mark.parametrize("ppm", [0, 100, Fraction(-1000, 7)])
def test_they_are_those_of_an_engine(ppm: Fraction) -> None:
    clock = Clock(frequency_hz=Fraction(16_000_000), ppm=ppm, phase=Fraction(1, 3))
    engine = open_engine(Design(name="counter", component=Counter, clocks=(clock,)), "pysim")
    end = femtoseconds(Fraction(200, 16_000_000))
    found = engine.advance(end, Trace({}, FEMTOSECOND, 0, end))["count"]
    edges = Edges(clock)
    assert found == edges.wave(np.arange(300), np.arange(300), 16, end)
    assert edges.count(end) == len(found)


@given(clocks, st.lists(st.integers(0, 10**9), unique=True, max_size=20))
def test_what_is_sampled_is_what_the_edge_at_the_ticks_end_finds(
    clock: Clock, times: list[int]
) -> None:
    edges = Edges(clock)
    wave = Waveform.of([0, *sorted(times)], np.arange(len(times) + 1) % 2)
    ticks = np.arange(edges.count(10**9))
    assert (edges.sampled(wave).at(ticks) == wave.at(edges.begin(ticks + 1) - 1)).all()


@given(clocks, st.lists(st.integers(0, 10**12), min_size=1, max_size=5))
def test_another_clocks_count_is_within_half_a_period(clock: Clock, ticks: list[int]) -> None:
    for tick, count in zip(ticks, Edges(clock).counted(ticks, 16_000).tolist(), strict=True):
        assert abs((tick + clock.phase) * clock.period * 16_000 - count) <= Fraction(1, 2)


def test_femtoseconds_are_rounded_up() -> None:
    assert femtoseconds(Fraction(1, 3)) == 333_333_333_333_334
    assert femtoseconds(Fraction(2)) == 2 * 10**15
