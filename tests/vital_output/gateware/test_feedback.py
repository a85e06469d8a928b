"""One output's feedback, against the contract's paragraph on it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from random import Random

import pytest

from railgate.vital_output.gateware.feedback import Feedback
from vital_output.gateware.bench import Bench, high, values
from vital_output.small import SMALL

pytestmark = pytest.mark.shows("DRV-8")

LOW, HIGH, ZERO = SMALL.period_low_ticks, SMALL.period_high_ticks, SMALL.zero_ticks
PULSE_DELAY = 3 + SMALL.feedback_filter_ticks
CONTACT_DELAY = 3 + SMALL.contact_filter_ticks
WIDTH = 20
UNFILTERED = replace(SMALL, feedback_filter_ticks=0, contact_filter_ticks=0)


@cache
def bench(config=SMALL):
    return Bench(Feedback(config))


def train(*rises):
    """The pulse pin's levels so that its rises are told in these ticks."""
    levels = {}
    for tick in rises:
        levels |= {tick - PULSE_DELAY: 1, tick - PULSE_DELAY + WIDTH: 0}
    return {"pulse_pin": levels}


def test_at_start_there_is_0_hz():
    result = bench().run(100, {})
    assert not any(high(result, name) for name in ("fb", "frequency", "contact"))


def test_pulses_are_0_hz_again_when_no_rise_has_come_for_two_periods():
    result = bench().run(2000, train(100, 400))
    assert high(result, "fb") == [*range(101, 400 + ZERO)]


def test_two_rises_of_0_hz_apart_are_0_hz_in_between():
    result = bench().run(2000, train(100, 100 + ZERO))
    assert high(result, "fb") == [*range(101, 100 + ZERO), *range(101 + ZERO, 100 + 2 * ZERO)]


@pytest.mark.shows("DRV-10")
@pytest.mark.parametrize(
    ("period", "right"),
    [(LOW - 1, False), (LOW, True), (200, True), (HIGH, True), (HIGH + 1, False)],
)
def test_a_period_is_right_within_its_tolerance(period, right):
    second = 100 + period
    result = bench().run(2000, train(100, second))
    expected = [*range(second + 1, second + HIGH + 1)] if right else []
    assert high(result, "frequency") == expected


@pytest.mark.shows("DRV-10")
def test_the_frequency_is_right_from_the_second_rise_to_the_first_that_is_wrong():
    result = bench().run(2000, train(100, 300, 500, 700, 700 + LOW - 1, 1200))
    assert high(result, "frequency") == [*range(301, 700 + LOW)]


@pytest.mark.shows("DRV-10")
def test_a_level_that_stays_is_not_the_right_frequency_and_not_fed():
    result = bench().run(2000, {"pulse_pin": {0: 0, 50: 1}})
    assert high(result, "fb") == [*range(51 + PULSE_DELAY, 50 + PULSE_DELAY + ZERO)]
    assert not high(result, "frequency")
    assert not high(bench().run(2000, {"pulse_pin": {0: 1}}), "fb")


def test_a_closed_contact_is_fed():
    result = bench().run(200, {"contact_pin": {0: 0, 50: 1, 90: 0}})
    closed = [*range(50 + CONTACT_DELAY, 90 + CONTACT_DELAY)]
    assert high(result, "contact") == high(result, "fb") == closed


def test_levels_as_short_as_their_filter_vanish():
    def seen(name, length):
        return high(bench().run(200, {name: {0: 0, 50: 1, 50 + length: 0}}), "fb")

    assert not seen("pulse_pin", SMALL.feedback_filter_ticks)
    assert seen("pulse_pin", SMALL.feedback_filter_ticks + 1)
    assert not seen("contact_pin", SMALL.contact_filter_ticks)
    assert seen("contact_pin", SMALL.contact_filter_ticks + 1)


def expected(rises, closed, count):
    """Frequency and fb in each tick, sentence by sentence."""
    since, frequency, told = ZERO, False, []
    for tick in range(count):
        told.append((frequency, closed[tick] or since < ZERO))
        if tick in rises:
            frequency = LOW <= since <= HIGH
            since = 1
        else:
            frequency = frequency and since < HIGH
            since = min(since + 1, ZERO)
    return told


@pytest.mark.parametrize("seed", range(3))
def test_random_feedback_has_the_frequency_of_the_contract(seed):
    random, count = Random(seed), 20_000
    pulse, contact, tick = {0: 0}, {0: 0}, 20
    while tick < count:
        pulse |= {tick: 1, tick + random.choice([1, 50, LOW - 2]): 0}
        tick += random.choice([LOW - 1, LOW, 200, HIGH, HIGH + 1, ZERO - 1, ZERO, ZERO + 1, 900])
        contact[tick + 7] = random.randrange(2)
    result = bench(UNFILTERED).run(count, {"pulse_pin": pulse, "contact_pin": contact})
    rises = {tick + 3 for tick, level in pulse.items() if level}
    level, closed = 0, []
    for tick in range(count):
        level = contact.get(tick - 3, level)
        closed.append(level)
    found = zip(values(result, "frequency"), values(result, "fb"), strict=True)
    assert list(found) == expected(rises, closed, count)
    assert high(result, "frequency")
