"""The closed loop: gateware and model are the same, tick for tick, whatever goes wrong (SYS-2)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.engines import Design, Engine, open_engine
from railgate.vital_output.loop import loop
from railgate.vital_output.plant.faults import FAULTS
from railgate.vital_output.plant.relay import RelayTimes
from railgate.vital_output.plant.scenario import Scenario
from railgate.vital_output.spec import Config
from railgate.waves import Trace, Waveform
from vital_output.equality import assert_same, opened
from vital_output.runs import RELAY
from vital_output.scenarios import clocks, odd_clocks, scenarios
from vital_output.small import SMALL

pytestmark = pytest.mark.shows("SYS-2")

MILLI = Fraction(1, 1000)
OTHER = Config(
    clock_hz=1_000_000,
    tolerance_ppm=150,
    outputs=5,
    boards=(0x1234_5678, 0x8765_4321),
    polynomial=0x04C1_1DB7,
    cycle_s=24 * MILLI,
    margin_s=MILLI,
    slew_ticks=60,
    holdover_cycles=8,
    delay_cycles=1,
    life_cycles=2,
    tau0_s=11 * MILLI,
    tau1_s=12 * MILLI,
    bit_ticks=5,
    link_filter_ticks=1,
    line_ticks=4,
    spare_messages=1,
    lost_messages=3,
    window_messages=64,
    drift_limit_ppm=500,
    pulse_hz=4_000,
    pulse_tolerance=Fraction(1, 8),
    feedback_filter_ticks=0,
    contact_filter_ticks=9,
    pick_up_s=2 * MILLI,
    release_s=12 * MILLI,
    release_min_s=11 * MILLI,
    error_interval_s=100 * MILLI,
    zero_at_once=True,
    count_bits=6,
)
SLOW = RelayTimes(clock_hz=160_001, pick_up_s=MILLI, release_s=11 * MILLI)


@dataclass(frozen=True)
class Case:
    """A pair that is built once, its lines' delay, and the clocks that it has."""

    config: Config
    relay: RelayTimes = RELAY
    delay_ticks: int = 0
    ppm_1: Fraction = Fraction(0)
    ppm_2: Fraction = Fraction(0)
    phase_1: Fraction = Fraction(0)
    phase_2: Fraction = Fraction(0)

    @property
    def timing(self) -> dict[str, Fraction]:
        names = ("ppm_1", "ppm_2", "phase_1", "phase_2")
        return {name: getattr(self, name) for name in names}

    @cached_property
    def made(self) -> Callable[[], Design]:
        clocks = Scenario(relay=self.relay, **self.timing).clocks(self.config)
        return partial(loop, self.config, self.relay, clocks, self.delay_ticks)


SAME = Case(SMALL)
APART = Case(SMALL, ppm_1=Fraction(100), ppm_2=Fraction(-100), phase_2=Fraction(1, 3))
OFF = Case(SMALL, ppm_1=Fraction(-73), ppm_2=Fraction(900), phase_1=Fraction(7, 1000))
LONG = Case(OTHER, SLOW, 4, ppm_1=Fraction(-150), ppm_2=Fraction(91), phase_1=Fraction(1, 2))
CASES = (SAME, APART, OFF, LONG)
BROAD = Case(replace(OTHER, outputs=23, spare_messages=0), SLOW, phase_1=Fraction(1, 7))
"""Its states are wider than one signal."""


def stimulus(case: Case, data: st.DataObject, cycles: int) -> Trace:
    """Any faults, and resets of the relays."""
    timing = st.just(case.timing)
    drawn = scenarios(case.config, cycles, timing, FAULTS, 4, case.relay)
    inputs = data.draw(drawn).controls(case.config)
    starts = data.draw(st.sets(st.integers(1, inputs.end // RESET - 1), max_size=2))
    ticks = [0, *(at * RESET + part for at in sorted(starts) for part in (0, RESET // 2))]
    rst = Waveform.of(ticks, np.arange(len(ticks)) & 1)
    return inputs.merge(Trace({"relay_rst": rst}, inputs.period, 0, inputs.end))


RESET = 10**10
"""Femtoseconds from one possible reset to the next: some of the relays' ticks."""

SHORT = 15 * 10**12
"""Femtoseconds of a run in the slowest engine: FPGA 1's test."""

QUIET = ("pulses", "link_tx")
"""Outputs on which a model need not dwell where nobody asks for them."""


def assert_pair_is_the_same(case: Case, inputs: Trace, rtl: Engine, cut: int) -> None:
    """With all outputs at one go, and without pulses and cross-link in two pieces."""
    found = rtl.advance(inputs.end, inputs)
    whole = open_engine(case.made(), "leap").advance(inputs.end, inputs)
    assert_same(whole, found, case)
    few = [name for name in found.signals if not name.endswith(QUIET)]
    leap = open_engine(case.made(), "leap")
    pieces = [leap.advance(end, inputs, few) for end in (cut, inputs.end)]
    assert_same(pieces[0].concatenate(*pieces[1:]), found.select(few), case)


def assert_cases(case: Case, data: st.DataObject, cycles: int) -> None:
    inputs = stimulus(case, data, cycles)
    cut = data.draw(st.integers(1, inputs.end - 1))
    assert_pair_is_the_same(case, inputs, opened(case.made, "cxxrtl"), cut)


@given(st.sampled_from(CASES), st.data())
@settings(max_examples=6, deadline=None)
def test_the_pair_is_that_of_leap_whatever_goes_wrong(case: Case, data: st.DataObject) -> None:
    assert_cases(case, data, 8)


@pytest.mark.slow
@given(st.data())
@settings(max_examples=10, deadline=None)
def test_the_pair_of_pysim_is_that_of_leap_whatever_goes_wrong(data: st.DataObject) -> None:
    inputs = stimulus(APART, data, 1).slice(0, SHORT)
    assert_pair_is_the_same(APART, inputs, open_engine(APART.made(), "pysim"), SHORT // 2)


@pytest.mark.slow
@given(st.sampled_from((*CASES, BROAD)), st.data())
@settings(max_examples=100, deadline=None)
def test_the_pair_is_that_of_leap_whatever_goes_wrong_for_long(
    case: Case, data: st.DataObject
) -> None:
    assert_cases(case, data, 30)


@pytest.mark.slow
@given(clocks() | odd_clocks(), st.data())
@settings(max_examples=20, deadline=None)
def test_the_pair_is_that_of_leap_whatever_its_clocks_are(
    timing: dict[str, Fraction], data: st.DataObject
) -> None:
    case = Case(SMALL, **timing)
    inputs = stimulus(case, data, 20)
    cut = data.draw(st.integers(1, inputs.end - 1))
    assert_pair_is_the_same(case, inputs, open_engine(case.made(), "cxxrtl"), cut)
