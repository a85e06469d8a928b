"""The rule of the door release, condition by condition."""

from __future__ import annotations

import pytest

from railgate.unit.application import Replica, Rule, View, decide
from railgate.unit.route import Call, Side, Stop

LEFT = Call(Stop(at_m=100, side=Side.LEFT), 0.0, 30.0)
RIGHT = Call(Stop(at_m=500, side=Side.RIGHT), 60.0, 90.0)
CYCLE_S = 0.05


def release(
    times_s: tuple[float, float], standstill: bool = True, position_m: float | None = 100.0
) -> int:
    """What a replica would command at the end of a span in which nothing has changed."""
    replica, image = Replica(Rule(), [LEFT, RIGHT]), 0
    for n in range(round((times_s[1] - times_s[0]) / CYCLE_S) + 1):
        image = replica.update(times_s[0] + n * CYCLE_S, standstill, position_m).image
    return image


def test_the_doors_of_the_platforms_side_are_released() -> None:
    assert release((5, 8)) == 1 << Side.LEFT.value
    assert release((65, 68), position_m=500.0) == 1 << Side.RIGHT.value


def test_nothing_is_released_unless_the_train_stands() -> None:
    assert release((5, 8), standstill=False) == 0


@pytest.mark.parametrize("position_m", [None, 97.9, 102.1, 300.0])
def test_nothing_is_released_away_from_a_platform_or_without_a_position(
    position_m: float | None,
) -> None:
    assert release((5, 8), position_m=position_m) == 0


@pytest.mark.parametrize("times_s", [(26, 29), (57, 59.9)])
def test_nothing_is_released_unless_the_driver_asks(times_s: tuple[float, float]) -> None:
    assert release(times_s, position_m=100.0 if times_s[1] < 30 else 500.0) == 0


def test_nothing_is_released_before_the_position_has_been_still() -> None:
    assert release((5, 6.9)) == 0
    assert release((5, 7.05)) == 1


def test_wheels_that_stand_for_ever_do_not_keep_the_doors_released_when_the_train_leaves() -> None:
    """Both cables were cut while the train stood: its odometer goes on to report standstill."""
    replica = Replica(Rule(), [LEFT])
    images = []
    for n in range(200):
        moved = max(n * CYCLE_S - 5, 0) ** 2 / 2
        images.append(replica.update(n * CYCLE_S, True, 100 + moved).image)
    released = [n * CYCLE_S for n, image in enumerate(images) if image]
    assert released[0] == pytest.approx(2.0)
    assert released[-1] == pytest.approx(6.0)  # half a metre on: a second after it has left
    assert images[121:] == [0] * 79


def test_the_position_begins_anew_after_a_loss() -> None:
    replica = Replica(Rule(), [LEFT])
    told = [replica.update(n * CYCLE_S, True, None if n == 60 else 100.0).image for n in range(110)]
    assert told[59] == 1
    assert told[60:100] == [0] * 40
    assert told[102] == 1


def test_only_what_both_replicas_say_is_commanded() -> None:
    one, both, none = View(True, 1), View(True, 3), View(False, 0)
    assert decide([one, both]) == 1
    assert decide([one, none]) == 0
    assert decide([both, both]) == 3
    assert decide([both, None]) == 0
