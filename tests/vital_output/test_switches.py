"""Every switch on and off, with unrelated clocks: no alarm, no frame missed, both trains together.

Requirements DRV-1, DRV-14.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise, zip_longest

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.vital_output.plant.edges import FEMTOSECOND
from railgate.vital_output.plant.scenario import Scenario
from railgate.vital_output.situations import ready_s
from railgate.vital_output.spec import Config
from railgate.waves import Trace, Waveform
from vital_output.messages import Line
from vital_output.pair import inputs, run, wrong
from vital_output.scenarios import scenarios
from vital_output.small import SMALL

pytestmark = pytest.mark.shows("DRV-14", kind="sweep")

MILLI = Fraction(1, 1000)
TICK = 10**15 // SMALL.clock_hz
"""Femtoseconds."""

DELAYS = st.integers(0, SMALL.line_ticks)
SETTLED = 4
"""Cycles after which a contact has followed a command."""


@given(scenarios(SMALL, 40))
@settings(max_examples=8, deadline=None)
def test_no_switch_on_or_off_raises_an_alarm(scenario: Scenario) -> None:
    assert_switches(scenario, SMALL)


def assert_switches(scenario: Scenario, config: Config, given_: Trace | None = None) -> int:
    """Nothing is counted but what is right, every frame is stored, every contact follows. How many
    switches there were."""
    found = run(scenario, config, given_)
    assert wrong(found) == ({}, {})
    contact, image = found.trace["contact"], 0
    switches = 0
    for command, then in pairwise((*scenario.commands, None)):
        end = scenario.seconds if then is None else then.start_s
        switches += (command.image ^ image).bit_count()
        image = command.image
        if end - command.start_s >= SETTLED * config.cycle_s:
            assert contact.at(int(end / FEMTOSECOND) - 1) == image
    for channel in found.channels:
        assert channel.total("start") == 1
        assert len(channel.frames) - 1 - channel.total("stored") <= 1  # the last one, at the end
    return switches


SPARE = replace(
    SMALL,
    cycle_s=24 * MILLI,
    tau0_s=9 * MILLI,
    tau1_s=9 * MILLI,
    spare_messages=1,
    lost_messages=3,
    release_min_s=8 * MILLI,
)
"""Of two messages one after the other one may be lost."""


@pytest.mark.shows("DRV-10")
@given(scenarios(SPARE, 20), st.integers(0, 1 << 32))
@settings(max_examples=6, deadline=None)
def test_no_single_lost_message_raises_an_alarm_or_stops_a_switch(
    scenario: Scenario, seed: int
) -> None:
    assert_switches(scenario, SPARE, losing(scenario, seed))


def losing(scenario: Scenario, seed: int) -> Trace:
    """Messages do not come, at random, but never two in a row on one line."""
    random, wires = np.random.default_rng(seed), {}
    whole = (1 << SPARE.layout.message_bits) - 1
    count = int(scenario.seconds * SPARE.clock_hz) // SPARE.link_period_ticks - 2
    for fpga in (1, 2):
        lost = np.arange(0, count - 1, 3) + random.integers(0, 2, -(-(count - 1) // 3))
        patterns = dict.fromkeys(lost.tolist(), whole)
        wires[f"line_{fpga}.high"] = Line(scenario, SPARE, fpga).disturbed(patterns)
    return inputs(scenario, SPARE, wires=wires)


PULSES = ("fpga_1.pulses", "fpga_2.pulses")


def starts(pulses: Waveform, output: int) -> list[int]:
    """The femtoseconds in which a train begins."""
    level = pulses.values >> output & 1
    rises = pulses.ticks[1:][(level[1:] == 1) & (level[:-1] == 0)]
    pauses = np.diff(rises, prepend=rises[:1] - 2**62) > 2 * SMALL.period_ticks * TICK
    return rises[pauses].tolist()


def worst_start(scenario: Scenario, delay_ticks: int) -> Fraction:
    """The longest from the one train's beginning to the other's, in ticks.

    One that has not begun in the run does so at its end at the earliest.
    """
    found = run(scenario, SMALL, None, delay_ticks, PULSES).trace
    ready = int(ready_s(SMALL) / FEMTOSECOND)
    apart = [Fraction(0)]
    for output in range(SMALL.outputs):
        one, other = ([at for at in starts(found[n], output) if at > ready] for n in PULSES)
        both = zip_longest(one, other, fillvalue=found.end)
        apart += [Fraction(abs(a - b), TICK) for a, b in both]
    return max(apart)


@given(scenarios(SMALL, 30), DELAYS)
@settings(max_examples=6, deadline=None)
def test_both_trains_begin_within_4_ticks_and_the_links_latency(
    scenario: Scenario, delay_ticks: int
) -> None:
    assert worst_start(scenario, delay_ticks) <= 4 + SMALL.latency_ticks


@pytest.mark.slow
def test_no_switch_of_tens_of_thousands_raises_an_alarm() -> None:
    switches = 0

    @given(scenarios(SMALL, 80), scenarios(SPARE, 40), st.integers(0, 1 << 32))
    @settings(max_examples=1_000, deadline=None)
    def count(small: Scenario, spare: Scenario, seed: int) -> None:
        nonlocal switches
        switches += assert_switches(small, SMALL)
        switches += assert_switches(spare, SPARE, losing(spare, seed))

    count()
    assert switches > 20_000


@pytest.mark.slow
@given(scenarios(SMALL, 60), DELAYS)
@settings(max_examples=1_000, deadline=None)
def test_both_trains_begin_within_4_ticks_and_the_links_latency_for_long(
    scenario: Scenario, delay_ticks: int
) -> None:
    assert worst_start(scenario, delay_ticks) <= 4 + SMALL.latency_ticks
