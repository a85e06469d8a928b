"""Wheel and sensor faults: where they are, and nowhere else."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest

from railgate.odometer.plant import Profile, Sensor, constant
from railgate.unit.faults import FAULTS, Fault, sensors, wheel

PROFILE = constant(72, 20)  # 20 m/s


def speeds(*faults: Fault, axle: int = 1) -> Profile:
    return wheel(PROFILE, axle, faults)


@pytest.mark.parametrize(
    ("kind", "value", "inside"), [("locked", None, 0.0), ("slip", 20, 24.0), ("slide", 25, 15.0)]
)
def test_a_wheel_leaves_the_trains_speed_and_comes_back(
    kind: str, value: int | None, inside: float
) -> None:
    fault = Fault(part="wheel", kind=kind, start_s=Fraction(5), end_s=Fraction(9), value=value)
    turned = speeds(fault)
    at = turned.speed_kmh(np.array([4.9, 6.0, 8.9, 9.6, 15.0])) / 3.6
    assert at == pytest.approx([20, inside, inside, 20, 20], abs=0.2)
    other = speeds(fault, axle=2)
    assert other.speed_kmh(np.array([7.0])) == pytest.approx(72)


def test_a_cut_cable_stops_both_channels_of_one_axle() -> None:
    cut = Fault(part="wheel", kind="cable-cut", start_s=Fraction(3), axle=2)
    lost = Fault(part="wheel", kind="b-lost", start_s=Fraction(4), axle=1)
    one, two = sensors(Sensor(), [cut, lost], 0)
    assert (one.a_dead_s, one.b_dead_s) == (math.inf, 4)
    assert (two.a_dead_s, two.b_dead_s) == (3, 3)
    assert one.offset != two.offset
    assert one.seed != two.seed


@pytest.mark.parametrize(
    ("made", "told"),
    [
        ({"kind": "locked", "value": 3}, "value must be between 1 and 99, of slip and slide"),
        ({"kind": "slip", "value": 100}, "value must be between 1 and 99"),
        ({"kind": "a-lost", "end_s": Fraction(2)}, "a-lost must last to the end"),
        ({"kind": "locked", "end_s": Fraction(1)}, "locked must end after it begins"),
        ({"kind": "locked", "axle": 0}, "axle must be between 1 and 2, not 0"),
    ],
)
def test_what_no_wheel_does_is_refused(made: dict[str, object], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        Fault(part="wheel", start_s=Fraction(1), **made)  # type: ignore[arg-type]


@pytest.mark.parametrize("part", FAULTS)
def test_every_kind_is_one(part: str) -> None:
    for kind in FAULTS[part]:
        assert Fault(part=part, kind=kind, start_s=Fraction(1)).kind == kind
