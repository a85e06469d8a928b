"""Counters and the first cause, against the contract's paragraph on the status."""

from __future__ import annotations

from functools import cache
from random import Random

import pytest

from railgate.vital_output.gateware.status import Status
from railgate.vital_output.spec import CAUSES, Cause
from vital_output.gateware.bench import Bench, pulses, values
from vital_output.small import SMALL

NAMES = [cause.name.lower() for cause in CAUSES]
COUNTED = ("accepted", "start", "passed", "stored")
ALARMS = ("handshake_alarm", "feedback_alarm")
ONES = (1 << SMALL.outputs) - 1
WRAPS = 1 << SMALL.count_bits


@cache
def bench():
    return Bench(Status(SMALL))


def run(end, **told):
    return bench().run(end, {name: pulses(ticks) for name, ticks in told.items()})


def first(result, tick):
    return Cause(values(result, "first_cause")[tick]), values(result, "first_output")[tick]


@pytest.mark.shows("DRV-5")
@pytest.mark.parametrize("name", [*COUNTED, *NAMES])
def test_each_event_counts_by_itself_from_the_next_tick_on(name):
    result = run(20, **{name: [5, 6, 9]})
    for other in (*COUNTED, *NAMES, "lost"):
        counts = values(result, f"{other}_count")
        expected = [0, 1, 2, 3] if other == name else [0] * 4
        assert [counts[tick] for tick in (5, 6, 7, 10)] == expected


def test_counters_wrap():
    assert values(run(WRAPS + 20, upset=range(WRAPS + 3)), "upset_count")[-1] == 3


@pytest.mark.shows("DRV-5")
def test_lost_frames_count_with_the_frame_that_tells_them():
    result = run(20, accepted=[5, 8], lost={4: 2, 5: 2, 6: 1, 8: 1})
    counts = values(result, "lost_count")
    assert [counts[tick] for tick in (5, 6, 8, 9, 19)] == [0, 2, 2, 3, 3]


def test_an_alarm_counts_once_a_tick_whatever_outputs_enter_it():
    result = run(20, feedback_alarm={5: 0b11, 6: 0b10})
    assert values(result, "feedback_alarm_count")[-1] == 2


@pytest.mark.parametrize("cause", CAUSES)
def test_of_several_causes_the_lowest_is_first_and_stays(cause):
    later = {other.name.lower(): [5] for other in CAUSES if other >= cause}
    result = run(20, **later | {"format": [5, 8] if cause is Cause.FORMAT else [8]})
    assert first(result, 5) == (Cause.NONE, 0)
    assert {first(result, tick)[0] for tick in range(6, 20)} == {cause}


@pytest.mark.parametrize("name", ALARMS)
@pytest.mark.parametrize("entering", range(1, ONES + 1))
def test_an_alarm_names_the_lowest_output_that_enters_it(name, entering):
    other = {"feedback_alarm": {5: ONES}} if name == "handshake_alarm" else {}
    result = run(20, **other | {name: {5: entering}, "upset": [5]})
    assert first(result, 6) == (Cause[name.upper()], 0 if entering & 1 else 1)


def test_a_cause_that_is_no_alarm_names_no_output():
    for name in set(NAMES) - set(ALARMS):
        later = (
            {}
            if Cause[name.upper()] > Cause.FEEDBACK_ALARM
            else {alarm: {5: 0b10} for alarm in ALARMS}
        )
        assert first(run(20, **{name: [5]} | later), 6) == (Cause[name.upper()], 0)


def test_an_acknowledgement_clears_the_first_cause_and_one_of_its_tick_is_first():
    result = run(30, handshake_alarm={5: 0b10}, skew=[10], acknowledged=[9, 10])
    assert first(result, 9) == (Cause.HANDSHAKE_ALARM, 1)
    assert first(result, 10) == (Cause.NONE, 0)
    assert first(result, 11) == first(result, 29) == (Cause.SKEW, 0)


def expected(ticks):
    """First cause and output in each tick, sentence by sentence."""
    cause, output, found = Cause.NONE, 0, []
    for told in ticks:
        found.append((cause, output))
        if told["acknowledged"]:
            cause, output = Cause.NONE, 0
        causes = [one for one in CAUSES if told[one.name.lower()]]
        if cause is Cause.NONE and causes:
            cause = causes[0]
            name = cause.name.lower()
            outputs = [i for i in range(SMALL.outputs) if name in ALARMS and told[name] >> i & 1]
            output = min(outputs, default=0)
    return found


def test_random_causes_are_latched_as_the_contract_has_it():
    random, count = Random(1), 10_000
    ticks = [
        {
            name: random.randrange(1, ONES + 1 if name in ALARMS else 2)
            if random.random() < (0.2 if name in ALARMS else 0.02)
            else 0
            for name in (*NAMES, "acknowledged")
        }
        for _ in range(count)
    ]
    names = (*NAMES, "acknowledged")
    given = {name: {k: told[name] for k, told in enumerate(ticks)} for name in names}
    result = bench().run(count, given)
    found = zip(values(result, "first_cause"), values(result, "first_output"), strict=True)
    assert list(found) == expected(ticks)
