"""The closed loop: gateware and model are the same, tick for tick, whatever goes wrong (SYS-2)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, partial

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.engines import Design, open_engine
from railgate.vital_output.loop import loop
from railgate.vital_output.plant.faults import FAULTS
from railgate.vital_output.plant.relay import RelayTimes
from railgate.vital_output.plant.scenario import Scenario
from railgate.vital_output.spec import Config
from railgate.waves import Trace, Waveform
from vital_output.equality import assert_same, opened
from vital_output.runs import RELAY
from vital_output.scenarios import scenarios
from vital_output.small import SMALL

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


def stimulus(case: Case, data: st.DataObject, cycles: int) -> Trace:
    """Any faults, and resets of the relays."""
    drawn = scenarios(case.config, cycles, case.timing, FAULTS, 4, case.relay)
    inputs = data.draw(drawn).controls(case.config)
    starts = data.draw(st.sets(st.integers(1, inputs.end // RESET - 1), max_size=2))
    ticks = [0, *(at * RESET + part for at in sorted(starts) for part in (0, RESET // 2))]
    rst = Waveform.of(ticks, np.arange(len(ticks)) & 1)
    return inputs.merge(Trace({"relay_rst": rst}, inputs.period, 0, inputs.end))


RESET = 10**10
"""Femtoseconds from one possible reset to the next: some of the relays' ticks."""

QUIET = ("pulses", "link_tx")
"""Outputs on which a model need not dwell where nobody asks for them."""


def assert_pair_is_the_same(
    case: Case, inputs: Trace, kind: str = "cxxrtl", cut: int | None = None
) -> Trace:
    """With all outputs at one go, and without pulses and cross-link in two pieces."""
    found = opened(case.made, kind).advance(inputs.end, inputs)
    whole = open_engine(case.made(), "leap").advance(inputs.end, inputs)
    assert_same(whole, found, case)
    few = [name for name in found.signals if not name.endswith(QUIET)]
    leap = open_engine(case.made(), "leap")
    ends = (inputs.end // 3 if cut is None else cut, inputs.end)
    pieces = [leap.advance(end, inputs, few) for end in ends]
    assert_same(pieces[0].concatenate(*pieces[1:]), found.select(few), case)
    return found


@given(st.sampled_from(CASES), st.data())
@settings(max_examples=32, deadline=None)
def test_the_pair_is_that_of_leap_whatever_goes_wrong(case: Case, data: st.DataObject) -> None:
    inputs = stimulus(case, data, 10)
    assert_pair_is_the_same(case, inputs, cut=data.draw(st.integers(1, inputs.end - 1)))


@given(st.data())
@settings(max_examples=2, deadline=None)
def test_the_pair_of_pysim_is_that_of_leap_whatever_goes_wrong(data: st.DataObject) -> None:
    inputs = stimulus(APART, data, 1)
    assert_pair_is_the_same(APART, inputs.slice(0, 15 * 10**12), "pysim")
