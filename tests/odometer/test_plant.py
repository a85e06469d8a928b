"""The plant makes what a wheel and a two-channel sensor would."""

import numpy as np
import pytest

from railgate.odometer.plant import (
    CONDITIONS,
    PROFILES,
    SERVICES,
    Profile,
    Sensor,
    constant,
    journey,
    read_profile,
    run,
    shuttle,
)
from railgate.odometer.spec import Config
from railgate.waves import Trace

CONFIG = Config(sensors=1)
PITCH = CONFIG.pitch_m


def steps(trace: Trace) -> np.ndarray:
    """The ×4 position at each edge, from the Gray code of the levels. Shape (edges,)."""
    ticks = np.union1d(trace["a"].ticks, trace["b"].ticks)
    gray = np.array([0, 3, 1, 2])[2 * trace["a"].at(ticks) + trace["b"].at(ticks)]
    moves = (np.diff(gray) + 1) % 4 - 1
    assert (moves != 2).all(), "an undisturbed sensor never changes both channels in one tick"
    return np.cumsum(moves)


@pytest.mark.parametrize("name", PROFILES)
def test_steps_follow_the_profile_to_within_one(name: str) -> None:
    profile = PROFILES[name](120, 4)
    trace = Sensor().drive(profile, CONFIG)
    end = profile.position_m(np.array([profile.duration_s]))[0] / (PITCH / 4)
    assert abs(steps(trace)[-1] - end) <= 1


@pytest.mark.shows("ODO-1")
def test_200_kmh_is_5441_hz() -> None:
    rising = Sensor().drive(constant(200, 2), CONFIG)["a"].rising()
    assert (rising.size - 1) / (rising[-1] - rising[0]) * 16e6 == pytest.approx(5441.2, abs=0.1)


@pytest.mark.shows("ODO-1")
@pytest.mark.parametrize(("speed", "lag"), [(100, 0.25), (-100, 0.75)])
def test_b_lags_a_by_90_degrees_forward_and_270_in_reverse(speed: float, lag: float) -> None:
    trace = Sensor().drive(constant(speed, 0.1), CONFIG)
    a, b = trace["a"].rising(), trace["b"].rising()
    period = (a[-1] - a[0]) / (a.size - 1)
    after = b[np.searchsorted(b, a[1:-1])] - a[1:-1]
    assert np.allclose(after / period, lag, atol=2 / period)


def test_duty_and_phase_errors_show_in_the_edges() -> None:
    trace = Sensor(duty=0.4, phase_deg=72).drive(constant(100, 0.1), CONFIG)
    a = trace["a"]
    period = np.diff(a.rising()).mean()
    rise = a.rising()[1:-1]
    assert np.allclose(
        (a.falling()[np.searchsorted(a.falling(), rise)] - rise) / period, 0.4, atol=2e-3
    )
    b = trace["b"].rising()
    assert np.allclose((b[np.searchsorted(b, rise)] - rise) / period, 0.2, atol=2e-3)


def test_tooth_errors_repeat_each_revolution_and_keep_their_bound() -> None:
    rising = Sensor(tooth_error=0.05).drive(constant(100, 1.5), CONFIG)["a"].rising()
    period = 3.6 * PITCH * 16e6 / 100
    places = (rising - rising[0]) / period
    errors = places - np.arange(places.size)
    assert np.ptp(errors) > 0.08
    assert np.abs(np.diff(errors)).max() <= 0.1 + 2 / period
    turn = CONFIG.pulses_per_rev
    assert np.allclose(errors[turn:], errors[:-turn], atol=2 / period)


def test_jitter_delays_each_edge_by_at_most_its_bound() -> None:
    clean = Sensor().drive(constant(100, 0.5), CONFIG)["a"].ticks
    late = Sensor(jitter_s=5e-6).drive(constant(100, 0.5), CONFIG)["a"].ticks
    delay = late - clean
    assert delay.min() >= 0
    assert 70 < delay.max() <= 81


def test_lost_pulses_are_whole_pulses_of_the_share_asked_for() -> None:
    clean = Sensor().drive(constant(200, 2), CONFIG)
    lossy = Sensor(dropouts=0.1).drive(constant(200, 2), CONFIG)
    for name in "ab":
        kept = lossy[name].rising().size / clean[name].rising().size
        assert kept == pytest.approx(0.9, abs=0.02)
        assert np.isin(lossy[name].ticks, clean[name].ticks).all()


def test_glitches_have_their_rate_and_length() -> None:
    trace = Sensor(glitches_hz=200, glitch_s=2e-6).drive(constant(0, 5), CONFIG)
    for name in "ab":
        ticks = trace[name].ticks[1:]
        assert ticks.size / 2 == pytest.approx(1000, rel=0.15)
        assert np.median(np.diff(ticks)[::2]) == 32


def test_a_dead_channel_holds_its_level() -> None:
    trace = Sensor(b_dead_s=0.5).drive(constant(100, 1), CONFIG)
    assert trace["b"].ticks[-1] < 8_000_000 < 15_900_000 < trace["a"].ticks[-1]


def test_a_reversal_returns_to_the_same_tooth() -> None:
    walked = steps(Sensor().drive(shuttle(30, 4), CONFIG))
    assert walked[-1] == 0
    assert walked.max() > 1000


def test_standstill_makes_no_edges() -> None:
    trace = Sensor().drive(constant(0, 1), CONFIG)
    assert len(trace["a"]) == len(trace["b"]) == 1


def test_one_seed_makes_one_run() -> None:
    def drive(seed: int) -> Trace:
        sensor = Sensor(tooth_error=0.1, jitter_s=1e-6, dropouts=0.05, glitches_hz=50, seed=seed)
        return sensor.drive(constant(80, 0.5), CONFIG)

    assert drive(1) == drive(1)
    assert drive(1) != drive(2)


def test_a_profile_reads_back_from_its_file(tmp_path) -> None:
    path = tmp_path / "profile.csv"
    path.write_text("time_s,speed_kmh\n0,0\n10,36\n20,-36\n")
    profile = read_profile(path)
    assert profile.speed_kmh(np.array([5.0, 10.0, 15.0, 20.0])) == pytest.approx([18, 36, 0, -36])
    assert profile.position_m(np.array([10.0, 15.0, 20.0])) == pytest.approx([50, 75, 50])


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "must have the columns time_s,speed_kmh, not none"),
        ("t,v\n0,0\n", "must have the columns time_s,speed_kmh, not t,v"),
        ("time_s,speed_kmh\n0,0\n", "at least two points"),
        ("time_s,speed_kmh\n0,0\n1,fast\n", "line 3: two numbers are needed, not 1,fast"),
        ("time_s,speed_kmh\n0,0\n1,nan\n", "must be finite"),
        ("time_s,speed_kmh\n0,0\n2,1\n1,1\n", "must rise strictly from 0 s"),
    ],
)
def test_a_bad_profile_is_one_clear_line(tmp_path, text: str, says: str) -> None:
    path = tmp_path / "profile.csv"
    path.write_text(text)
    with pytest.raises(ValueError, match=says) as caught:
        read_profile(path)
    assert "\n" not in str(caught.value)


def test_a_missing_profile_is_one_clear_line(tmp_path) -> None:
    with pytest.raises(ValueError, match="cannot be read as a profile"):
        read_profile(tmp_path / "none.csv")


def test_speed_and_position_agree() -> None:
    profile = Profile(np.array([0.0, 1.0, 3.0]), np.array([0.0, 10.0, -10.0]))
    t = np.linspace(0, 3, 301)
    slope = np.gradient(profile.position_m(t), t)
    assert np.allclose(3.6 * slope[1:-1], profile.speed_kmh(t)[1:-1], atol=0.2)


@pytest.mark.parametrize(("name", "value"), [("duty", 0.0), ("dropouts", 2.0), ("jitter_s", -1.0)])
def test_a_sensor_out_of_bounds_is_refused(name: str, value: float) -> None:
    with pytest.raises(ValueError, match=f"{name} must be between"):
        Sensor(**{name: value})


@pytest.mark.parametrize("profile", [run(90, 20), constant(40, 3)])
def test_what_has_passed_at_a_tick_is_what_the_edges_say(profile: Profile) -> None:
    sensor = Sensor(offset=0.3, tooth_error=0.2, duty=0.45, phase_deg=80, seed=7)
    pins = sensor.drive(profile, CONFIG)
    some = np.concatenate([pins["a"].ticks[1:200], pins["a"].ticks[1:200] - 1])
    ticks = np.unique(np.concatenate([some, np.arange(5, pins.end, 100_003)]))
    passed = sensor.passed(profile, CONFIG, ticks)
    a, b = pins["a"].rising(), pins["b"].rising()
    assert (passed.rises == np.searchsorted(a, ticks, side="right")).all()
    assert (passed.b_rises == np.searchsorted(b, ticks, side="right")).all()
    edges = np.sort(np.concatenate([pins[name].ticks[1:] for name in "ab"]))
    steps = np.searchsorted(edges, ticks, side="right")
    assert (passed.steps == steps).all()
    assert (passed.last_edge[steps > 0] == edges[steps[steps > 0] - 1]).all()
    some = passed.rises > 0
    assert (passed.last_rise[some] == a[passed.rises[some] - 1]).all()
    assert (passed.last_rise[~some] == 0).all()


@pytest.mark.parametrize("name", SERVICES)
def test_a_service_keeps_its_figures(name: str) -> None:
    service = SERVICES[name]
    train, phases = service.profile()
    assert 3.6 * train.speeds_m_s.max() == pytest.approx(service.speed_kmh)
    assert train.acceleration_m_s2 == pytest.approx(max(service.traction, service.braking))
    rates = np.diff(train.speeds_m_s) / np.diff(train.times_s)
    assert rates.max() == pytest.approx(service.traction)
    assert np.abs(np.diff(rates)).max() < 0.25
    assert [what for what, *_ in phases] == ["traction", "braking"] * service.hops
    slower, _ = service.profile(service.braking / 2)
    assert slower.duration_s > train.duration_s


@pytest.mark.parametrize("condition", CONDITIONS)
@pytest.mark.parametrize("name", SERVICES)
def test_wheels_leave_the_train_only_in_the_spans_told(name: str, condition: str) -> None:
    trip = journey(SERVICES[name], condition, 4)
    assert [len(spans) > 0 for spans in trip.off] == {
        "wet": [True, True],
        "slide": [True, True],
        "locked": [False, True],
    }.get(condition, [False, False])
    t = np.arange(0, trip.train.duration_s, 0.01)
    for wheel, spans, of in zip(trip.wheels, trip.off, ("slips", "slides"), strict=True):
        slip = wheel.speed_kmh(t) - trip.train.speed_kmh(t)
        inside = np.zeros(t.size, bool)
        for start, end in spans:
            inside |= (t > start) & (t < end)
        assert (np.abs(slip[~inside]) < 1e-9).all()
        assert (wheel.speeds_m_s >= 0).all()
        if spans and condition == "wet" and of == "slips":
            assert (slip > -1e-9).all()
        else:
            assert (slip < 1e-9).all()
    if condition in ("wet", "slide"):
        assert min(s[0] for spans in trip.off for s in spans) > SERVICES[name].dwell_s / 2


def test_a_slide_begins_faster_than_the_train_can_brake_and_lengthens_its_way() -> None:
    for service in SERVICES.values():
        dry, wet = journey(service, "dry", 1), journey(service, "slide", 1)
        assert wet.train.duration_s > dry.train.duration_s
        for wheel in wet.wheels:
            assert 1.9 < wheel.acceleration_m_s2 < 20


def test_a_locked_axle_stands_until_the_train_does() -> None:
    trip = journey(SERVICES["metro"], "locked", 1)
    for start, end in trip.off[1]:
        t = np.linspace(start + 4, end, 100)
        assert (trip.wheels[1].speed_kmh(t) == 0).all()
        assert trip.train.speed_kmh(np.array(end)) == 0


def test_a_journey_comes_from_its_seed_alone() -> None:
    one, same, other = (journey(SERVICES["metro"], "slide", seed) for seed in (1, 1, 2))
    assert one.off == same.off != other.off
    assert (one.wheels[0].times_s == same.wheels[0].times_s).all()
    with pytest.raises(ValueError, match=r"condition must be one of dry, wet, .*, not ice"):
        journey(SERVICES["metro"], "ice", 1)
