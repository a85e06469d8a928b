"""The peer's clock by the times of its messages, through the receiver."""

from __future__ import annotations

from functools import cache

import pytest

from railgate.vital_output.gateware.crosslink import LinkReceiver
from vital_output.gateware.bench import Bench, high
from vital_output.gateware.messages import line, message, verdict_ticks
from vital_output.small import SMALL

pytestmark = pytest.mark.shows("DRV-17")

LIMIT, WINDOW = SMALL.drift_limit_ticks, SMALL.window_messages
VERDICT = verdict_ticks(SMALL)


@cache
def receiver():
    return Bench(LinkReceiver(SMALL, 1))


def received(offsets, numbers=None):
    """What is told of messages that come so many ticks later than one every period, and the ticks
    of their verdicts."""
    numbers = numbers or range(len(offsets))
    starts = [
        100 + number * SMALL.link_period_ticks + offset
        for number, offset in zip(numbers, offsets, strict=True)
    ]
    bits = {
        start: message(SMALL, 0, number=number % 256)
        for start, number in zip(starts, numbers, strict=True)
    }
    end = starts[-1] + SMALL.message_ticks + 40
    result = receiver().run(end, {"link_rx": line(SMALL, bits)})
    verdicts = [start + VERDICT for start in starts]
    assert high(result, "taken") == verdicts[1:]
    assert high(result, "lost") == []
    return result, verdicts


def found_off(offsets, numbers=None):
    """The places of the messages with which the clock is found off."""
    result, verdicts = received(offsets, numbers)
    return [verdicts.index(tick) for tick in high(result, "off_frequency")]


@pytest.mark.parametrize("sign", [1, -1])
def test_a_clock_is_off_beyond_the_limit_and_good_again_after_a_window(sign):
    assert found_off([0, 0] + [sign * LIMIT] * 3) == []
    result, verdicts = received([0, 0] + [sign * (LIMIT + 1)] * (WINDOW + 4))
    found, passed = verdicts[2], verdicts[2 + WINDOW]
    assert high(result, "off_frequency") == [found]
    assert high(result, "drifting") == [*range(found + 1, passed + 1)]
    assert result["peer_ok"].ticks.tolist() == [0, verdicts[1] + 1, found + 1, passed + 1]


def test_the_offset_is_counted_over_a_window_and_then_begins_anew():
    first = [0, 0] + [LIMIT] * WINDOW
    assert found_off([*first, 2 * LIMIT]) == []
    assert found_off([*first, 2 * LIMIT + 1]) == [2 + WINDOW]
    assert found_off([*first[:-1], LIMIT + 1]) == [1 + WINDOW]


def test_a_clock_that_creeps_is_found_within_the_declared_time():
    """Beyond the limit by the resolution of 4 ticks in a window."""
    creep = (LIMIT + 4) / WINDOW
    offsets = [round(place * creep) for place in range(3 * WINDOW)]
    result, verdicts = received(offsets)
    assert high(result, "off_frequency")[0] - verdicts[1] <= SMALL.drift_detection_ticks
    within = (LIMIT - 4) / WINDOW
    assert found_off([round(place * within) for place in range(3 * WINDOW)]) == []


def test_messages_missing_on_the_way_are_no_drift():
    numbers = [0, 1, 2, 4, 6, 7, 9, 10]
    assert found_off([0] * 8, numbers) == []
    assert found_off([0, 0, 0, LIMIT + 1, 0, 0, 0, 0], numbers)[0] == 3
