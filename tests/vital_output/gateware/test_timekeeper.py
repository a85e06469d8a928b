"""The channel's time, against the sentences of the contract and against a count of every tick."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from random import Random

import pytest

from railgate.vital_output.gateware.timekeeper import Timekeeper
from vital_output.gateware.bench import Bench, high, pulses, values
from vital_output.small import SMALL

pytestmark = pytest.mark.shows("DRV-3")

CYCLE, SLEW, MARGIN = SMALL.cycle_ticks, SMALL.slew_ticks, SMALL.margin_ticks
TOP = (1 << 32) - 1


@cache
def bench():
    return Bench(Timekeeper(SMALL))


def run(end, updates, lifeless=None):
    """Updates are {tick: (index, phase)}."""
    inputs = {
        "valid": pulses(list(updates)),
        "index_in": pulses({tick: index for tick, (index, _) in updates.items()}),
        "phase_in": pulses({tick: phase for tick, (_, phase) in updates.items()}),
        "lifeless": lifeless or {},
    }
    return bench().run(end, inputs)


def time(result, tick):
    return int(result["index"].at(tick)), int(result["phase"].at(tick))


def cycles(result):
    """The ticks in which a new index begins."""
    return result["index"].ticks[1:].tolist()


def test_unseated_it_counts_by_itself_and_trusts_nothing():
    result = run(2 * CYCLE + 3, {})
    assert [time(result, tick) for tick in (0, 1, CYCLE - 1, CYCLE, 2 * CYCLE + 2)] == [
        (0, 0),
        (0, 1),
        (0, CYCLE - 1),
        (1, 0),
        (2, 2),
    ]
    assert high(result, "trusted") == high(result, "jump") == []


def test_the_first_update_seats_and_the_second_one_is_trusted():
    result = run(60, {20: (99, 4000), 50: (99, 4030)})
    assert [time(result, tick) for tick in (20, 21, 22)] == [(0, 20), (99, 4001), (99, 4002)]
    assert high(result, "trusted") == list(range(51, 60))
    assert high(result, "jump") == []


def test_seated_with_the_last_phase_the_next_tick_begins_a_cycle():
    result = run(30, {20: (99, CYCLE - 1)})
    assert [time(result, tick) for tick in (21, 22)] == [(100, 0), (100, 1)]
    assert time(run(30, {20: (TOP, CYCLE - 1)}), 21) == (0, 0)


def test_an_update_beyond_the_cycle_is_none():
    result = run(60, {20: (99, CYCLE), 30: (99, CYCLE + 9)})
    assert time(result, 59) == (0, 59)


@pytest.mark.parametrize(
    ("ahead", "lengths"),
    [
        (50, [CYCLE - 20, CYCLE - 20, CYCLE - 10, CYCLE]),
        (-50, [CYCLE + 20, CYCLE + 20, CYCLE + 10, CYCLE]),
        (7, [CYCLE - 7, CYCLE, CYCLE, CYCLE]),
        (-20, [CYCLE + 20, CYCLE, CYCLE, CYCLE]),
        (0, [CYCLE, CYCLE, CYCLE, CYCLE]),
    ],
)
def test_a_good_update_is_followed_by_the_slew_at_most_in_a_cycle(ahead, lengths):
    result = run(4 * CYCLE + 200, {0: (7, 0), 1000: (7, 1000 + ahead)})
    ends = [0, *cycles(result)[1:]]
    assert [b - a for a, b in pairwise(ends)] == lengths
    assert values(result, "index")[-1] == 11


def test_a_correction_of_the_tick_in_which_the_cycle_ends_is_not_lost():
    # Pending is 30: the cycle ends 20 early, in tick CYCLE - 21, with an update that is 35 ahead.
    tick = CYCLE - 21
    result = run(3 * CYCLE, {0: (7, 0), 1000: (7, 1030), tick: (8, tick + 35 - CYCLE)})
    ends = cycles(result)[1:]
    assert ends[0] == tick + 1
    assert [b - a for a, b in pairwise(ends)] == [CYCLE - 15, CYCLE]


@pytest.mark.parametrize("ahead", [MARGIN, -MARGIN, MARGIN + 1, -MARGIN - 1])
@pytest.mark.parametrize("phase", [MARGIN - 30, CYCLE - MARGIN + 30, CYCLE // 2])
def test_an_update_is_good_up_to_the_margin_on_both_sides_of_a_cycles_boundary(phase, ahead):
    update = divmod(7 * CYCLE + phase + ahead, CYCLE)
    result = run(20, {9: (7, phase - 9), 10: (7, phase - 8), 18: update})
    assert time(result, 18) == (7, phase)
    good = abs(ahead) <= MARGIN
    assert high(result, "jump") == ([] if good else [18])
    assert result["trusted"].at(19) == good


def test_the_index_wraps():
    result = run(CYCLE, {0: (TOP, CYCLE - 20), 5: (TOP, CYCLE - 15), 40: (0, 20), 45: (TOP, 25)})
    assert [time(result, tick) for tick in (19, 20)] == [(TOP, CYCLE - 1), (0, 0)]
    assert high(result, "jump") == [45]


FAR = [
    ((7, 5 + MARGIN + 1), True),
    ((7, 5 + 9 * MARGIN), True),
    ((8, 0), True),
    ((7 + (1 << 31) - 1, 3), True),
    ((7 + (1 << 31), 3), False),
    ((6, CYCLE - 1 - MARGIN), False),
    ((5, CYCLE - 1), False),
]


@pytest.mark.parametrize(("update", "ahead"), FAR)
@pytest.mark.parametrize("lifeless", [False, True])
def test_time_jumps_only_forwards_and_only_without_life(update, ahead, lifeless):
    result = run(20, {0: (7, 0), 2: (7, 2), 5: update}, {0: int(lifeless)})
    jumps = not (ahead and lifeless)
    assert high(result, "jump") == ([5] if jumps else [])
    assert time(result, 6) == ((7, 6) if jumps else (update[0], update[1] + 1))
    assert high(result, "trusted") == [3, 4, 5]


def test_a_jump_is_trusted_again_after_a_good_update():
    result = run(60, {0: (7, 0), 2: (7, 2), 10: (9, 0), 30: (7, 30)})
    assert high(result, "trusted") == [*range(3, 11), *range(31, 60)]


def test_time_is_trusted_through_the_holdover_and_no_longer():
    end = SMALL.holdover_cycles * CYCLE
    result = run(end + 3 * CYCLE, {0: (7, 0), 9: (7, 9), end + 50: (7 + 20, 50)})
    assert cycles(result)[20] == end
    assert result["trusted"].ticks.tolist() == [0, 10, end, end + 51]


def test_a_good_update_in_the_tick_in_which_the_last_cycle_ends_wins():
    end = SMALL.holdover_cycles * CYCLE
    result = run(end + 9, {0: (7, 0), 9: (7, 9), end - 1: (26, CYCLE - 1)})
    assert result["trusted"].ticks.tolist() == [0, 10]


@pytest.mark.shows("DRV-7")
def test_each_cycle_has_one_tick_of_decision():
    result = run(3 * CYCLE, {0: (7, 0)})
    decides = SMALL.margin_ticks + SMALL.tau0_ticks + SMALL.latency_ticks
    assert high(result, "decides") == [decides, CYCLE + decides, 2 * CYCLE + decides]


@dataclass
class Count:
    """The contract's time, one tick after the other."""

    index: int = 0
    phase: int = 0
    pending: int = 0
    holdover: int = 0
    seated: bool = False
    consistent: bool = False

    def told(self):
        trusted = self.consistent and self.holdover < SMALL.holdover_cycles
        return self.index, self.phase, int(trusted)

    def tick(self, update, lifeless):
        """Whether the update is a jump."""
        c = max(-SLEW, min(SLEW, self.pending))
        ends = self.phase + c >= CYCLE - 1
        index, phase, seated = self.index, self.phase, self.seated
        self.phase = 0 if ends else self.phase + 1
        if ends:
            self.index = (self.index + 1) & TOP
            self.pending -= c
            self.holdover = min(self.holdover + 1, SMALL.holdover_cycles)
        if update is None or update[1] >= CYCLE:
            return False
        step = (update[0] - index + (1 << 31) & TOP) - (1 << 31)
        d = step * CYCLE + update[1] - phase
        if seated and abs(step) <= 1 and abs(d) <= MARGIN:
            self.pending = d - (c if ends else 0)
            self.consistent, self.holdover = True, 0
        elif not seated or (lifeless and (step > 0 or (step == 0 and d >= 0))):
            whole = update[0] * CYCLE + update[1] + 1
            self.index, self.phase = whole // CYCLE & TOP, whole % CYCLE
            self.pending, self.holdover, self.seated, self.consistent = 0, 0, True, False
        else:
            self.consistent = False
            return True
        return False


def stimulus(random, end):
    """Updates of a network's time that drifts, and now and then is off a little, or much."""
    updates = {}
    start = random.choice([5, 0, TOP, 1 << 31]) * CYCLE + random.randrange(CYCLE)
    tick = random.randrange(50)
    while tick < end:
        start += random.choice([0, 0, 0, 1, -1, 15, -15, 90, -250, 299, -301, 5 * CYCLE, -CYCLE])
        index, phase = divmod(start + tick, CYCLE)
        updates[tick] = (index & TOP, random.choice([phase] * 9 + [CYCLE + 5]))
        near_end = CYCLE - 1 - phase + random.randrange(-25, 5)
        tick += max(1, random.choice([1, random.randrange(2000), near_end, CYCLE - 20]))
    changes = sorted(random.sample(range(end), 8))
    return updates, {at: number % 2 for number, at in enumerate(changes)}


@pytest.mark.parametrize("seed", range(25))
def test_whatever_the_network_tells_time_is_as_counted(seed):
    end = 6 * CYCLE
    updates, lifeless = stimulus(Random(seed), end)
    result = run(end, updates, lifeless)
    count, without_life, expected, jumps = Count(), 0, [], []
    for tick in range(end):
        expected.append(count.told())
        without_life = lifeless.get(tick, without_life)
        if count.tick(updates.get(tick), without_life):
            jumps.append(tick)
    told = (values(result, name) for name in ("index", "phase", "trusted"))
    assert list(zip(*told, strict=True)) == expected
    assert high(result, "jump") == jumps
