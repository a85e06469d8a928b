"""Gateware and model are the same, tick for tick (SYS-2)."""

from __future__ import annotations

from fractions import Fraction
from functools import reduce
from operator import or_

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from position_link.equality import assert_fixed_phase, assert_same, gateware, leap, opened
from position_link.random_lines import configs, line
from position_link.stimuli import short
from railgate.engines import Engine, open_engine
from railgate.position_link.design import design
from railgate.position_link.plant import Scenario, drive
from railgate.position_link.spec import EVEN, Cause, Check, Config, Edge, Health, Status
from railgate.waves import Trace

pytestmark = pytest.mark.shows("SYS-2")

SEEDS = st.integers(0, 1 << 32)
WIDE_CHECK = Check(width=33, polynomial=0x1_2345_6789, initial=7, final=0x0_FEDC_BA98)

BARE = short(
    Fraction(8),
    word_bits=8,
    timeout_bits=1,
    request_bits=2,
    filter_ticks=3,
    guard_ticks=0,
    earliest_clk=1,
    bare=True,
    count_bits=8,
    age_bits=2,
    age_ticks_bits=16,
    fault_word=0x5A,
)
COMPILED = (
    BARE,
    short(
        Fraction(125, 14),
        1,
        word_bits=64,
        timeout_bits=4,
        request_bits=3,
        timeout_from_end=True,
        filter_ticks=0,
        guard_ticks=1,
        sampling_edge=Edge.RISING,
        check=EVEN,
        tolerated_cycles=1,
        recovery_cycles=2,
        count_bits=8,
    ),
    short(
        Fraction(171, 10),
        3,
        word_bits=65,
        timeout_bits=7,
        request_bits=1,
        earliest_clk=5,
        filter_ticks=7,
        guard_ticks=3,
        zero_is_fault=True,
        tolerated_cycles=2,
        recovery_cycles=3,
        age_bits=2,
    ),
    short(
        Fraction(59, 7),
        2,
        word_bits=512,
        timeout_bits=2,
        request_bits=1,
        filter_ticks=2,
        guard_ticks=1,
        check=WIDE_CHECK,
        zero_is_fault=True,
        age_ticks_bits=16,
    ),
)
"""The shortest cycle, a parity, one bit more than a part, the widest word."""


def in_pieces(engine: Engine, inputs: Trace, cuts: list[int]) -> Trace:
    """The outputs from tick 0 on, run in pieces that end at `cuts`."""
    ends = [*sorted(cut for cut in cuts if cut <= inputs.end), inputs.end]
    pieces = [engine.advance(end, inputs) for end in ends]
    return pieces[0].concatenate(*pieces[1:])


def assert_line_is_the_same(config: Config, kind: str, seed: int, cycles: int) -> Trace:
    inputs = line(config, seed, cycles)
    found = gateware(config, inputs, kind)
    assert_same(leap(config, inputs), found, config, seed, cycles)
    assert_fixed_phase(config, inputs, found)
    return found


def any_of(found: list[Trace], name: str) -> set[int]:
    return {int(value) for trace in found for value in trace[name].values}


@pytest.mark.parametrize("config", COMPILED, ids=lambda config: f"{config.word_bits}-bits")
def test_leap_is_cxxrtl_on_any_line_and_the_lines_reach_everything(config: Config) -> None:
    found = [assert_line_is_the_same(config, "cxxrtl", seed, seed % 12) for seed in range(120)]
    never = Cause(0)
    never |= Cause(0) if config.check else Cause.CHECK
    never |= Cause(0) if config.zero_is_fault else Cause.ZERO_WORD
    never |= Cause(0) if config.guard_ticks else Cause.UNSTABLE
    never |= Cause.EARLY if config.earliest_clk == 1 else Cause(0)
    assert Cause(reduce(or_, any_of(found, "causes"))) == ~never
    health = {*Health} if config.recovery_cycles > 1 else {*Health} - {Health.RECOVERING}
    health -= set() if config.tolerated_cycles > 1 else {Health.WARNING}
    assert any_of(found, "health") == health
    status = {*Status} if config.tolerated_cycles > 1 else {Status.FAULT, Status.FRESH}
    assert any_of(found, "status") == status


@given(configs(), SEEDS, st.integers(0, 4))
@settings(max_examples=35, deadline=None)
def test_leap_is_pysim_on_any_line_in_any_configuration(
    config: Config, seed: int, cycles: int
) -> None:
    inputs = line(config, seed, cycles)
    found = open_engine(design(config), "pysim").advance(inputs.end, inputs)
    assert_same(leap(config, inputs), found, config, seed, cycles)
    assert_fixed_phase(config, inputs, found)


@pytest.mark.parametrize("config", COMPILED, ids=lambda config: f"{config.word_bits}-bits")
def test_pysim_is_cxxrtl(config: Config) -> None:
    inputs = line(config, seed=3, cycles=2)
    assert_same(gateware(config, inputs, "pysim"), gateware(config, inputs))


def cuts(config: Config) -> st.SearchStrategy[list[int]]:
    """Ticks of the first cycles, many between a decision and its delivery."""
    near = st.tuples(st.integers(0, 6), st.integers(-10, 2)).map(
        lambda at: 1 + at[0] * config.cycle_ticks + config.delivery_ticks + at[1]
    )
    return st.lists(near | st.integers(0, 7 * config.cycle_ticks), max_size=6)


@given(st.sampled_from(COMPILED[:3]), SEEDS, st.booleans(), st.data())
@settings(max_examples=80, deadline=None)
def test_pieces_of_leap_and_of_the_gateware_are_the_same(
    config: Config, seed: int, resets: bool, data: st.DataObject
) -> None:
    inputs = line(config, seed, 7, resets)
    split = in_pieces(open_engine(design(config), "leap"), inputs, data.draw(cuts(config)))
    engine = opened(design, "cxxrtl", config)
    assert_same(split, in_pieces(engine, inputs, data.draw(cuts(config))), config, seed)


@pytest.mark.parametrize("kind", ["cxxrtl", "pysim"])
def test_counts_wrap_and_ages_saturate_alike(kind: str) -> None:
    end = 70_000 if kind == "pysim" else 300_000
    inputs = drive(Scenario(), BARE, 2).extend(end)
    found = gateware(BARE, inputs, kind)
    assert_same(leap(BARE, inputs), found)
    assert_fixed_phase(BARE, inputs, found)
    assert found["number"].falling().size == end // (256 * BARE.cycle_ticks)
    assert found["age_ticks"].values.min() < found["age_ticks"].values[-1] == (1 << 16) - 1


@pytest.mark.slow
@given(st.sampled_from(COMPILED), SEEDS, st.integers(0, 20))
@settings(max_examples=10_000, deadline=None)
def test_leap_is_cxxrtl_on_very_many_lines(config: Config, seed: int, cycles: int) -> None:
    assert_line_is_the_same(config, "cxxrtl", seed, cycles)


@pytest.mark.slow
@given(configs(), SEEDS, st.integers(0, 8))
@settings(max_examples=300, deadline=None)
def test_leap_is_pysim_in_very_many_configurations(config: Config, seed: int, cycles: int) -> None:
    inputs = line(config, seed, cycles)
    found = open_engine(design(config), "pysim").advance(inputs.end, inputs)
    assert_same(leap(config, inputs), found, config, seed, cycles)
