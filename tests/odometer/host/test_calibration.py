"""The diameter from the steps between two known points holds the true one."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from railgate.odometer.host import Rolling, Train, calibrate
from railgate.odometer.judge import by_places, records, strobes
from railgate.odometer.plant import SERVICES, Journey, Profile, Sensor, journey
from railgate.odometer.spec import Assumptions, Config

pytestmark = pytest.mark.shows("ODO-15", "ODO-16")

CONFIG = Config()
TOOTH = 0.01
DAY = "2026-02-01"


def between(trip: Journey, start: int, end: int, rolling: Rolling | None = None) -> tuple:
    """A train whose reference is strobe `start` and which has come to strobe `end`, and the true
    distance between."""
    of = [Sensor(offset=0.1 + 0.4 * i, tooth_error=TOOTH, seed=i) for i in range(2)]
    seen = by_places(trip, CONFIG, of, strobes(trip, CONFIG))
    train = Train(CONFIG, Assumptions(tooth_error=TOOTH), records(trip), rolling)
    train.replay(seen[: start + 1])
    train.refer()
    train.replay(seen[start + 1 : end + 1])
    t = seen["time"][[start, end], 0] / CONFIG.clock_hz
    return train, float(np.diff(trip.train.position_m(t))[0])


@pytest.mark.parametrize("error_m", [0.0, 0.5, -0.5])
def test_the_true_diameters_lie_within_the_new_bounds_which_are_narrower(error_m: float) -> None:
    trip = journey(replace(SERVICES["long-distance"], cruise_s=60), "worn", 1)
    train, distance_m = between(trip, 3000, 10_000)
    assert distance_m > 3000
    for i, true in enumerate(trip.diameters_m):
        record = calibrate(train, i, distance_m + error_m, 0.5, DAY)
        old = train.wheels[i]
        assert record.least_m < true < record.greatest_m
        assert record.greatest_m - record.least_m < (old.greatest_m - old.least_m) / 5
        assert record.greatest_m - record.least_m == pytest.approx(
            2 * 0.65 * (0.5 + 0.0104) / distance_m, rel=0.02
        )
        assert abs(record.diameter_m - true) < 0.65 * 0.52 / distance_m
        assert (record.axle, record.day) == (old.axle, DAY)


def test_creep_widens_the_bounds() -> None:
    trip = journey(replace(SERVICES["metro"], hops=1), "dry", 1)
    train, distance_m = between(trip, 1000, 3000, Rolling(creep=0.001))
    record = calibrate(train, 0, distance_m, 0.0, DAY)
    assert record.greatest_m / record.least_m == pytest.approx(
        1.002 + 2 * 0.0104 / distance_m, rel=1e-5
    )


def test_the_new_record_narrows_the_distance() -> None:
    trip = journey(replace(SERVICES["metro"], hops=2), "worn", 2)
    train, distance_m = between(trip, 500, 4500)
    wheels = [calibrate(train, i, distance_m, 0.2, DAY) for i in range(2)]
    of = [Sensor(offset=0.1 + 0.4 * i, tooth_error=TOOTH, seed=i) for i in range(2)]
    seen = by_places(trip, CONFIG, of, strobes(trip, CONFIG))
    widths, errors = [], []
    for records_ in (train.wheels, wheels):
        again = Train(CONFIG, Assumptions(tooth_error=TOOTH), records_)
        again.replay(seen)
        state = again.state
        widths.append(state.distance_high_m - state.distance_low_m)
        errors.append(state.distance_m - trip.train.position_m(trip.train.times_s)[-1])
    assert widths[1] < widths[0] / 5
    assert abs(errors[1]) < 0.5 < abs(errors[0])


def test_an_axle_that_slid_on_the_way_or_did_not_turn_gives_no_diameter() -> None:
    trip = journey(replace(SERVICES["metro"], hops=1), "locked", 1)
    train, distance_m = between(trip, 1000, 5000)
    calibrate(train, 0, distance_m, 0.2, DAY)
    with pytest.raises(ValueError, match="axle 2 must have adhered since the reference"):
        calibrate(train, 1, distance_m, 0.2, DAY)
    rest = Profile(np.array([0.0, 2.0]), np.array([0.0, 0.0]))
    still, _ = between(
        Journey(rest, (rest, rest), ((), ()), (Fraction(65, 100),) * 2, ((0.65, 0.65, 0.65),) * 2),
        20,
        50,
    )
    with pytest.raises(ValueError, match="axle 1 must have turned since the reference"):
        calibrate(still, 0, 1000.0, 0.2, DAY)
    with pytest.raises(ValueError, match=r"distance_m must be a number above its tolerance 0\.2"):
        calibrate(train, 0, 0.1, 0.2, DAY)
