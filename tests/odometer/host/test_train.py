"""Trains whose truth is known: what two axles tell of them holds it, and who slips is found."""

import math
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from railgate.odometer.host import Rolling, Train, TrainState, Verdict, WheelRecord
from railgate.odometer.host.readout import Snapshot
from railgate.odometer.judge import by_model, by_places, judge, records, strobes
from railgate.odometer.plant import (
    CONDITIONS,
    SERVICES,
    Journey,
    Profile,
    Sensor,
    journey,
    run,
    shuttle,
)
from railgate.odometer.spec import Assumptions, Config, Flag

pytestmark = pytest.mark.shows("ODO-11", "ODO-15")

CONFIG = Config()
WINDOW_S = 0.02
TOOTH = 0.01
ADHERING, SLIPPING, SLIDING, LOST = Verdict
FIELDS = [field.name for field in (*CONFIG.common_fields, *CONFIG.sensor_fields)]


def line(*points: tuple[float, float]) -> Profile:
    """From points of time, s, and speed, km/h."""
    times, speeds = zip(*points, strict=True)
    return Profile(np.array(times), np.array(speeds) / 3.6)


def ride(train: Profile, *wheels: Profile, tolerance_m: float = 0.0) -> Journey:
    """Wheels as recorded, each moving as told."""
    recorded = ((0.65, 0.65 - tolerance_m, 0.65 + tolerance_m),) * len(wheels)
    return Journey(train, wheels, ((),) * len(wheels), (Fraction(65, 100),) * len(wheels), recorded)


def sensors(n: int, tooth: float = 0.0) -> list[Sensor]:
    return [Sensor(offset=0.1 + 0.37 * i, tooth_error=tooth, seed=i) for i in range(n)]


def follow(
    journey: Journey,
    rolling: Rolling | None = None,
    assumed: Assumptions | None = None,
    keep: int = 1,
    tooth: float = 0.0,
    of: Sequence[Sensor] = (),
) -> tuple[np.ndarray, list[TrainState]]:
    """Strobe times and what the train's odometry says, through the model."""
    ticks = strobes(journey, CONFIG, WINDOW_S)[::keep]
    seen = by_model(journey, CONFIG, of or sensors(len(journey.wheels), tooth), ticks)
    assumed = assumed or Assumptions(tooth_error=tooth, crystal_ppm=10)
    train = Train(CONFIG, assumed, records(journey), rolling)
    return ticks / CONFIG.clock_hz, [train.update(shots) for shots in snapshots(seen)]


def snapshots(seen: np.ndarray) -> list[list[Snapshot]]:
    """Snapshots of which all that the train does not use is 0."""
    used = seen.dtype.names
    return [
        [Snapshot(*(int(axle[f]) if f in used else 0 for f in FIELDS)) for axle in row]
        for row in seen
    ]


def outside(journey: Journey, times: np.ndarray, told: list[TrainState]) -> np.ndarray:
    """At which strobes the true speed or way is outside its interval."""
    t = times - (CONFIG.input_delay_ticks - 1) / CONFIG.clock_hz
    speed, way = journey.train.speed_kmh(t), journey.train.position_m(t)
    way = way - way[0]
    low, high = ([s.speed_low_kmh for s in told], [s.speed_high_kmh for s in told])
    least, most = ([s.distance_low_m for s in told], [s.distance_high_m for s in told])
    return (speed < low) | (speed > high) | (way < least) | (way > most)


def verdicts(told: list[TrainState]) -> np.ndarray:
    return np.array([s.verdicts for s in told])


# The judged journeys


@pytest.mark.parametrize("condition", CONDITIONS)
def test_the_truth_of_a_metro_is_never_outside_and_no_rolling_axle_is_accused(condition) -> None:
    trip = journey(replace(SERVICES["metro"], hops=1), condition, 3)
    assert_judged(trip, condition, by_model)


@pytest.mark.parametrize("condition", CONDITIONS)
@pytest.mark.parametrize("service", SERVICES)
def test_nor_is_that_of_any_service(service: str, condition: str) -> None:
    assert_judged(journey(SERVICES[service], condition, 7), condition, by_places)


@pytest.mark.slow
@pytest.mark.parametrize("condition", CONDITIONS)
@pytest.mark.parametrize("service", SERVICES)
def test_nor_is_it_through_the_model_or_with_many_seeds(service: str, condition: str) -> None:
    assert_judged(journey(SERVICES[service], condition, 100), condition, by_model)
    for seed in range(200, 220):
        assert_judged(journey(SERVICES[service], condition, seed), condition, by_places)


def assert_judged(trip: Journey, condition: str, through) -> None:
    ticks = strobes(trip, CONFIG, WINDOW_S)
    train = Train(CONFIG, Assumptions(tooth_error=TOOTH, crystal_ppm=10), records(trip))
    told = judge(trip, train, through(trip, CONFIG, sensors(2, TOOTH), ticks))
    assert told.outside == 0
    assert told.false_alarms == 0
    assert max(told.detect_s, default=0) <= 0.1
    assert told.within_etcs == 1 or (condition == "slide" and told.within_etcs > 0.6)
    spans = len(trip.off[0]) + len(trip.off[1])
    assert (len(told.detect_s), spans > 0) == (spans, condition in ("wet", "slide", "locked"))
    share = 0.0045 if condition == "worn" else 0.0012
    if condition != "slide":
        assert told.end_interval_m < share * trip.train.position_m(trip.train.times_s)[-1] + 1


def test_snapshots_from_places_are_those_of_the_model() -> None:
    for name, condition in (("metro", "slide"), ("metro", "wet"), ("freight", "locked")):
        trip = journey(replace(SERVICES[name], hops=1, cruise_s=5, speed_kmh=45), condition, 1)
        ticks = strobes(trip, CONFIG, WINDOW_S)
        ours, models = (
            through(trip, CONFIG, sensors(2, TOOTH), ticks) for through in (by_places, by_model)
        )
        for field in ours.dtype.names:
            assert (ours[field] == models[field]).all(), field


def test_strobe_by_strobe_is_the_same_as_all_at_once() -> None:
    trip = journey(replace(SERVICES["metro"], hops=1), "slide", 5)
    seen = by_places(trip, CONFIG, sensors(2), strobes(trip, CONFIG, WINDOW_S))
    one, all_ = (Train(CONFIG, Assumptions(), records(trip)) for _ in range(2))
    rows = all_.replay(seen)
    for row, shots in zip(rows, snapshots(seen), strict=True):
        state = one.update(shots)
        assert state.distance_m == row[3]
        assert (state.distance_low_m, state.distance_high_m) == tuple(row[4:6])
        assert state.verdicts == tuple(row[8:10])
    assert state == all_.state


# False alarms


def hours(windows: int, tooth: float) -> int:
    """Windows with a verdict, of trains that only roll, as hard as they are assumed to at most."""
    alarms = seen_ = 0
    for seed, service in enumerate(SERVICES.values()):
        one = journey(service, "dry", seed)
        hops = math.ceil(1.1 * windows / 3 * service.hops / strobes(one, CONFIG, WINDOW_S).size)
        trip = journey(replace(service, hops=hops), "dry", seed)
        seen = by_places(trip, CONFIG, sensors(2, tooth), strobes(trip, CONFIG, WINDOW_S))
        most = trip.train.acceleration_m_s2
        assumed = Assumptions(tooth_error=tooth, crystal_ppm=0, acceleration_max=most)
        told = judge(trip, Train(CONFIG, assumed, records(trip)), seen)
        assert told.outside == 0
        alarms, seen_ = alarms + told.false_alarms, seen_ + told.windows
    assert seen_ >= windows
    return alarms


@pytest.mark.parametrize("tooth", [0.0, TOOTH])
def test_no_false_alarm_in_a_hundred_thousand_windows(tooth: float) -> None:
    assert hours(100_000, tooth) == 0


@pytest.mark.slow
@pytest.mark.parametrize("tooth", [0.0, 0.001, TOOTH])
def test_no_false_alarm_in_a_million_windows(tooth: float) -> None:
    assert hours(1_000_000, tooth) == 0


# How soon


def slow_slip(kmh: float, slip: float, tooth: float, creep: float, seed: int) -> tuple[int, int]:
    """At a constant speed the first wheel begins to slip: how many whole windows it takes until a
    verdict, and the verdict."""
    random = np.random.default_rng(seed)
    onset, end = 4 + random.uniform(0, WINDOW_S), 8.0
    v = kmh / 3.6
    train = Profile(np.array([0, end]), np.array([v, v]))
    wheel = Profile(np.array([0, onset, end]), np.array([v, v, v + slip * (end - onset)]))
    trip = replace(
        ride(train, wheel, train, tolerance_m=0.0005),
        diameters_m=(Fraction(6502, 10_000), Fraction(6497, 10_000)),
    )
    of = [Sensor(offset=random.random(), tooth_error=tooth, seed=2 * seed + i) for i in range(2)]
    ticks = strobes(trip, CONFIG, WINDOW_S)
    assumed = Assumptions(tooth_error=tooth, crystal_ppm=10)
    train_ = Train(CONFIG, assumed, records(trip), Rolling(creep=creep))
    found = train_.replay(by_places(trip, CONFIG, of, ticks))[:, 8:10]
    alarms = np.flatnonzero(found.any(axis=1))
    before = np.searchsorted(ticks / CONFIG.clock_hz, onset)
    assert alarms[0] >= before
    return int(alarms[0] - before), int(found[alarms[0]].max())


@pytest.mark.parametrize("slip", [0.1, -0.1])
@pytest.mark.parametrize("kmh", [200, 80])
def test_a_slip_of_a_tenth_is_seen_in_the_first_whole_window_if_teeth_are_true(kmh, slip) -> None:
    for seed in range(10):
        windows, verdict = slow_slip(kmh, slip, 0.0, 0.0, seed)
        assert windows <= 1
        assert verdict == (SLIPPING if slip > 0 else SLIDING)


def test_with_tooth_error_it_takes_some_windows_and_with_creep_a_share_of_the_speed() -> None:
    assert max(slow_slip(200, 0.1, 0.001, 0.0, seed)[0] for seed in range(8)) <= 3
    assert 4 <= max(slow_slip(200, 0.1, 0.01, 0.0, seed)[0] for seed in range(8)) <= 8
    windows = slow_slip(200, 0.1, 0.0, 0.001, 1)[0]
    assert windows * WINDOW_S == pytest.approx(4 * 0.001 * 55.6 / 0.1, rel=0.2)


# Each inequality


@pytest.mark.parametrize(("rate", "verdict"), [(-1.65, SLIDING), (1.65, SLIPPING), (1.49, 0)])
def test_a_wheel_that_outdoes_the_train_is_caught_by_itself(rate: float, verdict: int) -> None:
    wheel = line((0, 100), (3, 100), (8, 100 + 5 * 3.6 * rate))
    times, told = follow(ride(line((0, 100), (8, 100)), wheel), tooth=0.001)
    found = verdicts(told)[:, 0]
    assert not found[times < 3].any()
    assert set(found[(times > 3.2) & (times < 8)]) == {verdict}


def test_edges_that_cease_are_a_slide_and_after_two_seconds_a_lost_axle() -> None:
    train = line((0, 80), (10, 80))
    trip = ride(train, train, train)
    dead = {"a_dead_s": 5.0, "b_dead_s": 5.0}
    times, told = follow(trip, of=[Sensor(), Sensor(offset=0.6, **dead)])
    found = verdicts(told)
    assert not found[times <= 5].any()
    assert not found[:, 0].any()
    assert set(found[(times > 5.04) & (times < 6.9), 1]) == {SLIDING}
    assert set(found[times > 7.1, 1]) == {LOST}
    assert not outside(trip, times, told).any()


def test_an_axle_whose_channels_disagree_is_lost_at_once_and_the_other_one_counts() -> None:
    train = line((0, 80), (6, 80))
    trip = ride(train, train, train)
    times, told = follow(trip, of=[Sensor(b_dead_s=3.0), Sensor(offset=0.6)])
    assert set(verdicts(told)[times > 3.06, 0]) == {LOST}
    assert not outside(trip, times, told).any()
    made = [
        later - sooner for later, sooner in zip(*(told[k].counted for k in (-1, 200)), strict=True)
    ]
    assert made[0] == 0
    assert made[1] == told[-1].steps[1] - told[200].steps[1]
    assert told[-1].compensated_m == 0


def test_wheels_beyond_their_records_are_told_by_their_ratio() -> None:
    train = line((0, 60), (4, 60))
    trip = replace(
        ride(train, train, train, tolerance_m=0.0005),
        diameters_m=(Fraction(65, 100), Fraction(648, 1000)),
    )
    _, told = follow(trip)
    assert verdicts(told)[5:].any(axis=1).all()
    assert not told[-1].rolled[0]
    assert not told[-1].rolled[1]


def crept(train: Profile, *points: tuple[float, float]) -> Profile:
    """A wheel whose speed is the train's and a part of it; points: of time and that part."""
    times, parts = zip(*points, strict=True)
    t = np.union1d(train.times_s, times)
    return Profile(t, train.speed_kmh(t) / 3.6 * (1 + np.interp(t, times, parts)))


@pytest.mark.parametrize("creep", [0.002, 0.0])
def test_creep_that_is_assumed_is_no_slip_and_is_in_the_bounds(creep: float) -> None:
    """The wheels' creep turns at 45 km/h within 0.1 s, the train speeding up nearly as it can."""
    train = line((0, 0), (1, 0), (12, 11 * 3.6 * 1.45), (30, 11 * 3.6 * 1.45))
    some, other = ((9, -0.002), (9.1, 0.002)), ((9, 0.002), (9.1, -0.002))
    for parts in ((some, other), (some, some), (other, other)):
        trip = ride(train, *(crept(train, *of) for of in parts))
        times, told = follow(trip, Rolling(creep=creep))
        wrong = bool(outside(trip, times, told).any() or verdicts(told).any())
        assert wrong == (creep == 0)


@pytest.mark.parametrize("condition", ["wet", "slide", "locked"])
def test_fifty_milliseconds_will_do_too(condition: str) -> None:
    for service in SERVICES.values():
        trip = journey(service, condition, 2)
        train = Train(CONFIG, Assumptions(tooth_error=TOOTH), records(trip), Rolling(confirm_s=0.2))
        seen = by_places(trip, CONFIG, sensors(2, TOOTH), strobes(trip, CONFIG, 0.05))
        told = judge(trip, train, seen)
        assert (told.outside, told.false_alarms) == (0, 0)
        assert max(told.detect_s) <= 0.15


# While it lasts


def test_while_both_axles_slide_the_bounds_follow_the_train_and_the_interval_grows() -> None:
    train = line((0, 100), (5, 100), (15, 72), (25, 72))
    slid = line((0, 100), (5, 100), (6, 60), (12, 40), (13, 77.6), (15, 72), (25, 72))
    other = line(
        (0, 100), (5, 100), (5.1, 99.72), (6, 65), (12, 38), (13.3, 76.76), (15, 72), (25, 72)
    )
    trip = ride(train, slid, other)
    times, told = follow(trip)
    assert not outside(trip, times, told).any()
    free = (verdicts(told) != ADHERING).all(axis=1)
    assert free[(times > 5.2) & (times < 13)].all()
    assert not free[(times < 5) | (times > 16)].any()
    width = np.array([s.distance_high_m - s.distance_low_m for s in told])
    assert (np.diff(width[free]) > 0).all()
    assert np.ptp(width[times > 16]) < 0.1
    assert 5 < width[-1] < 200
    assert all(s.distance_low_m <= s.distance_m <= s.distance_high_m for s in told)
    assert told[-1].compensated_m > 100
    assert told[np.searchsorted(times, 12.98)].speed_low_kmh > 75  # the recovering wheel's


def test_while_both_axles_slip_the_slower_wheel_bounds_the_train() -> None:
    train = line((0, 20), (20, 56))
    slips = line((0, 20), (5, 29), (5.3, 40), (6, 31.8), (9, 37.2), (9.2, 36.56), (20, 56))
    more = line((0, 20), (5, 29), (5.3, 42), (6, 32.8), (9, 38.2), (9.3, 36.74), (20, 56))
    trip = ride(train, slips, more)
    times, told = follow(trip)
    assert not outside(trip, times, told).any()
    free = (times > 5.2) & (times < 9)
    assert (verdicts(told)[free] == SLIPPING).all()
    high = np.array([s.speed_high_kmh for s in told])
    assert (high - train.speed_kmh(times))[(times > 6.1) & free].max() < 1.5
    assert not verdicts(told)[times > 10.7].any()


def test_where_both_axles_lock_the_bounds_fall_as_assumed() -> None:
    """Wheels locked from 5 s on, the train braking at a_max all the while, rolling again at 9 s."""
    train = line((0, 80), (5, 80), (10, 53), (13, 53))
    wheel = line((0, 80), (5, 80), (5.001, 0), (9, 0), (9.001, 58.3946), (10, 53), (13, 53))
    trip = ride(train, wheel, wheel)
    for rise in (0.0, -1.5):
        times, told = follow(trip, Rolling(slide_rise=rise))
        assert not outside(trip, times, told).any()
        locked = (times > 5.1) & (times < 9)
        assert (verdicts(told)[locked] != ADHERING).all()
        assert not verdicts(told)[(times < 5) | (times > 9.4)].any()
        for name, rate in (("speed_high_kmh", rise), ("speed_low_kmh", -1.5)):
            bound = np.array([getattr(s, name) for s in told])[locked]
            assert np.diff(bound) / WINDOW_S / 3.6 == pytest.approx(rate, rel=1e-3, abs=1e-9)
        assert not any(s.standstill for s in told)


def test_one_axle_is_taken_at_the_age_at_which_a_slide_would_have_been_found() -> None:
    """The only axle slides: unknown for some windows, in which the truth is inside all the same."""
    trip = ride(line((0, 90), (7, 90)), line((0, 90), (4, 90), (7, 90 - 3 * 3.6 * 1.62)))
    times, told = follow(trip, tooth=TOOTH)
    assert not outside(trip, times, told).any()
    _, bold = follow(trip, Rolling(confirm_s=0), tooth=TOOTH)
    assert outside(trip, times, bold)[(times > 4) & (times < 4.2)].any()
    wide, fine = (s[150].speed_high_kmh - s[150].speed_low_kmh for s in (told, bold))
    assert wide - fine == pytest.approx(2 * 3.6 * 1.5 * 0.1, rel=0.1)


@pytest.mark.parametrize("first", [0, 1])
def test_a_slip_that_comes_and_goes_leaves_its_doubt_in_the_way(first: int) -> None:
    """0.5 m/s² is within what the train can: which axle is right stays open, so both count."""
    train = line((0, 72), (12, 72))
    wheel = line((0, 72), (3, 72), (5, 75.6), (7, 72), (12, 72))
    trip = ride(train, *((wheel, train) if first == 0 else (train, wheel)))
    times, told = follow(trip)
    assert not outside(trip, times, told).any()
    found = verdicts(told)
    assert set(found[(times > 3.1) & (times < 7), first]) == {SLIPPING}
    assert not found[:, 1 - first].any()
    assert not found[(times < 3) | (times > 8.5)].any()
    width = told[-1].distance_high_m - told[-1].distance_low_m
    assert width == pytest.approx(2.0, abs=0.1)  # ½ · 1 m/s · 4 s
    assert abs(told[-1].distance_m - trip.train.position_m(times)[-1]) < 0.5


def test_an_axle_long_in_doubt_is_not_believed_when_the_other_one_slides() -> None:
    train = line((0, 72), (12, 72))
    slips = line((0, 72), (3, 72), (5, 75.6), (9, 75.6), (11, 72), (12, 72))
    slides = line((0, 72), (6, 72), (7, 54), (8, 72), (12, 72))
    trip = ride(train, slips, slides)
    times, told = follow(trip)
    assert not outside(trip, times, told).any()
    found = verdicts(told)
    assert set(found[(times > 3.1) & (times < 9), 0]) == {SLIPPING}
    assert set(found[(times > 6.1) & (times < 8), 1]) == {SLIDING}


def test_what_was_flagged_before_the_first_strobe_costs_nothing() -> None:
    train = line((0, 36), (3, 36))
    trip = ride(train, train, train)
    seen = by_places(trip, CONFIG, sensors(2), strobes(trip, CONFIG, WINDOW_S))
    seen["flags"][0] = Flag.ILLEGAL
    flagged, plain = (Train(CONFIG, Assumptions(), records(trip)) for _ in range(2))
    told = flagged.replay(seen)
    seen["flags"] = 0
    assert np.array_equal(told, plain.replay(seen))
    assert np.isfinite(told[5:]).all()


def test_false_edges_on_both_axles_are_no_sign_of_a_brake() -> None:
    train = line((0, 36), (2, 36), (4, 45))
    trip = ride(train, train, train)
    seen = by_places(trip, CONFIG, sensors(2), strobes(trip, CONFIG, WINDOW_S))
    seen["flags"][120:] = Flag.MISMATCH
    odometry = Train(CONFIG, Assumptions(), records(trip))
    told = odometry.replay(seen)
    assert told[-1, 2] > 45 / 3.6
    assert told[-1, 8:10].tolist() == [LOST, LOST]


def test_an_axle_is_believed_again_only_with_another_and_only_after_a_while() -> None:
    train = line((0, 90), (12, 90))
    held = line((0, 90), (3, 90), (3.4, 72), (12, 72))  # slides on at an even speed
    brief = line((0, 90), (4, 90), (4.5, 72), (5, 90), (12, 90))
    ends = (4.95, 4.97, 5.0, 5.02)  # of a fall through the other's speed
    for other in (brief, *(line((0, 90), (4, 90), (end, 54), (12, 50)) for end in ends)):
        trip = ride(train, held, other)
        times, told = follow(trip)
        found = verdicts(told)
        assert not outside(trip, times, told).any()
        assert (found[times > 3.1, 0] != ADHERING).all()
        assert (found[times > 4.1, 1] != ADHERING).all()


def test_the_only_axle_left_is_believed_again_after_two_seconds() -> None:
    train = line((0, 90), (14, 90))
    slides = line((0, 90), (6, 90), (6.4, 72), (7.4, 72), (7.8, 90), (14, 90))
    trip = ride(train, slides, train)
    of = [Sensor(), Sensor(offset=0.6, a_dead_s=1.0, b_dead_s=1.0)]
    times, told = follow(trip, of=of)
    assert not outside(trip, times, told).any()
    found = verdicts(told)
    assert set(found[times > 3.2, 1]) == {LOST}
    assert (found[(times > 6.1) & (times < 9.7), 0] != ADHERING).all()
    assert not found[times > 9.9, 0].any()


def test_the_wheel_is_within_a_pitch_of_what_its_steps_tell_whatever_duty_and_phase() -> None:
    train = line((0, 30), (6, 30))
    for duty, phase in ((0.1, 20), (0.9, 20), (0.5, 90), (0.2, 160)):
        trip = ride(train, train, train)
        of = [Sensor(duty=duty, phase_deg=phase, offset=k) for k in (0.05, 0.55)]
        seen = by_places(trip, CONFIG, of, strobes(trip, CONFIG, 0.0173))
        rolling = Rolling(confirm_s=0)
        train_ = Train(CONFIG, Assumptions(crystal_ppm=0), records(trip), rolling)
        assert judge(trip, train_, seen).outside == 0


# The train at rest, backwards, with lost replies


STOP = line((0, 80), (10, 80), (30, 0), (36, 0))
"""Braking at 1.11 m/s², then six seconds of rest."""


@pytest.mark.parametrize("keep", [1, 3])
@pytest.mark.parametrize(
    "profile", [STOP, run(70, 60), shuttle(30, 40), line((0, 0), (4, 0), (14, 50), (24, 3))]
)
def test_both_bounds_hold_all_the_way_also_backwards_and_where_replies_are_lost(
    profile: Profile, keep: int
) -> None:
    trip = ride(profile, profile, profile)
    times, told = follow(trip, keep=keep)
    assert not outside(trip, times, told).any()
    assert not verdicts(told).any()
    width = np.array([s.speed_high_kmh - s.speed_low_kmh for s in told])
    assert (width[times > 1] < 4.6).all()
    moving = np.abs(trip.train.speed_kmh(times)) > 10
    assert (width[moving] < 1.4 + 0.3 * keep).all()
    assert told[-1].steps == told[-1].counted or told[-1].counted[1] == 0


def test_standstill_is_claimed_of_a_train_at_rest_and_only_after_two_seconds() -> None:
    times, told = follow(ride(STOP, STOP, STOP))
    still = times[[s.standstill for s in told]]
    assert (np.diff(still) < 1.5 * WINDOW_S).all()
    assert still[-1] == times[-1]
    assert 31.5 < still[0] < 32.1


def test_one_axle_alone_never_claims_the_train_at_rest() -> None:
    _, told = follow(ride(STOP, STOP))
    assert not any(s.standstill for s in told)


def test_sensors_lost_at_speed_never_become_a_train_at_rest() -> None:
    train = line((0, 30), (20, 30))
    dead = {"a_dead_s": 2.0, "b_dead_s": 2.0}
    trip = ride(train, train, train)
    times, told = follow(trip, of=[Sensor(**dead), Sensor(offset=0.6, **dead)])
    assert not any(s.standstill for s in told)
    assert not outside(trip, times, told).any()
    assert told[-1].verdicts in ((SLIDING, SLIDING), (LOST, LOST))


def test_counters_and_time_may_wrap() -> None:
    trip = journey(replace(SERVICES["metro"], hops=1, cruise_s=2), "slide", 1)
    seen = by_places(trip, CONFIG, sensors(2), strobes(trip, CONFIG, WINDOW_S))
    wrapped = seen.copy()
    wrapped["time"] = (seen["time"] + (1 << 48) - 500_000_000) % (1 << 48)
    wrapped["a_rising"] = (seen["a_rising"] + (1 << 32) - 1000) % (1 << 32)
    wrapped["position"] = (seen["position"] + (1 << 31) + (1 << 31) - 4000) % (1 << 32) - (1 << 31)
    rows = [Train(CONFIG, Assumptions(), records(trip)).replay(s) for s in (seen, wrapped)]
    assert np.array_equal(*rows)


# The reference


def test_the_distance_counts_from_the_reference_with_its_tolerance() -> None:
    train = line((0, 72), (10, 72))
    for wheels in ((train, train), (train,)):
        trip = ride(train, *wheels, tolerance_m=0.0005)
        ticks = strobes(trip, CONFIG, WINDOW_S)
        odometry = Train(CONFIG, Assumptions(), records(trip))
        shots = snapshots(by_places(trip, CONFIG, sensors(len(wheels)), ticks))
        for strobe in shots[:250]:
            odometry.update(strobe)
        state = odometry.refer(0.5)
        assert (state.distance_m, state.distance_low_m, state.distance_high_m) == (0, -0.5, 0.5)
        for k, strobe in enumerate(shots[250:], start=1):
            state = odometry.update(strobe)
            true, half = 20 * WINDOW_S * k, 0.55 + 0.0008 * 20 * WINDOW_S * k
            assert state.distance_low_m <= true - 0.4 < true + 0.4 <= state.distance_high_m
            assert state.distance_high_m - state.distance_low_m < 2 * half
        assert state.rolled == (True,) * len(wheels)


def test_the_interval_is_held_against_that_of_etcs() -> None:
    state = TrainState(
        0, 0, 0, 100.0, 91.0, 109.9, False, (0, 0), (0, 0), (0, 0), 0.0, (True, True)
    )
    assert state.etcs_m == 10
    assert state.within_etcs
    assert not state._replace(distance_high_m=110.1).within_etcs


def test_what_it_rests_on_is_told_with_its_figures() -> None:
    told = Train(CONFIG, Assumptions(), records(ride(STOP, STOP)), Rolling(creep=0.002)).rests_on
    assert "a rolling wheel's speed is within ±0.2 % of the train's" in told
    assert "the train's acceleration is within ±1.5 m/s²" in told


@pytest.mark.parametrize("flag", [Flag.MISMATCH, Flag.A_MISSING, Flag.PHASE_FAULT, Flag.ILLEGAL])
def test_an_axle_whose_edges_are_false_is_not_believed(flag: Flag) -> None:
    trip = ride(line((0, 50), (2, 50)), *(line((0, 50), (2, 50)),) * 2)
    seen = by_places(trip, CONFIG, sensors(2), strobes(trip, CONFIG, WINDOW_S))
    seen[60, 0]["flags"] = flag
    found = Train(CONFIG, Assumptions(), records(trip)).replay(seen)[:, 8:10]
    assert found[60].tolist() == [LOST, ADHERING]
    assert (found[61:68, 0] != ADHERING).all()
    assert not found[:60].any()
    assert not found[75:].any()


def test_what_does_not_fit_is_refused() -> None:
    trip = ride(line((0, 30), (0.1, 30)), *(line((0, 30), (0.1, 30)),) * 2)
    wheels = records(trip)
    shots = snapshots(by_places(trip, CONFIG, sensors(2), strobes(trip, CONFIG, WINDOW_S)))
    with pytest.raises(ValueError, match="wheels must hold at least one record, not 0"):
        Train(CONFIG, Assumptions(), [])
    with pytest.raises(ValueError, match="standstill_s must be at most 268"):
        Train(CONFIG, Assumptions(), wheels, Rolling(standstill_s=300))
    with pytest.raises(ValueError, match=r"creep must be between 0 and 0\.2, not 1"):
        Rolling(creep=1)
    with pytest.raises(ValueError, match="a strobe needs 2 snapshots, one an axle, not 1"):
        Train(CONFIG, Assumptions(), wheels).update(shots[0][:1])
    with pytest.raises(ValueError, match="of one strobe"):
        Train(CONFIG, Assumptions(), wheels).update([shots[0][0], shots[1][1]])
    with pytest.raises(ValueError, match="tolerance_m must be a number of at least 0, not -1"):
        Train(CONFIG, Assumptions(), wheels).refer(-1)


def test_a_record_says_which_diameter() -> None:
    record = WheelRecord(axle="1", diameter_m=0.9, least_m=0.9, greatest_m=0.9, day="2026-01-01")
    profile = line((0, 36), (4, 36))
    trip = replace(ride(profile, profile), diameters_m=(Fraction(9, 10),))
    seen = by_places(trip, CONFIG, sensors(1), strobes(trip, CONFIG, WINDOW_S))
    train = Train(CONFIG, Assumptions(), [record])
    train.replay(seen)
    assert train.state.distance_m == pytest.approx(10 * 3.96, abs=0.02)
    assert train.state.speed_kmh == pytest.approx(36, abs=0.01)
