"""Trains whose truth is known, through a sensor and the model to what one axle tells of them."""

import numpy as np
import pytest

from railgate.odometer.host.estimators import Estimate
from railgate.odometer.host.readout import snapshots
from railgate.odometer.host.tracking import Axle
from railgate.odometer.model import Model
from railgate.odometer.plant import Profile, Sensor, run
from railgate.odometer.spec import Assumptions, Config
from railgate.waves import Trace, Waveform

pytestmark = pytest.mark.shows("ODO-11")

CONFIG = Config(sensors=1)
ASSUMED = Assumptions(crystal_ppm=10)
WINDOW_S = 0.02
SATURATED_KMH = 0.64
"""Where the bound of silence ends: √(2 · pitch · acceleration_max)."""


def line(*points: tuple[float, float]) -> Profile:
    """From points of time, s, and speed, km/h."""
    times, speeds = zip(*points, strict=True)
    return Profile(np.array(times), np.array(speeds) / 3.6)


def tracked(profile: Profile, sensor: Sensor, keep: int = 1) -> tuple[np.ndarray, list[Estimate]]:
    """Strobe times, s, and what the axle says of them, of every keep-th strobe."""
    every = round(WINDOW_S * CONFIG.clock_hz)
    pins = sensor.drive(profile, CONFIG)
    inputs = {f"sensor.0.{name}": wave for name, wave in pins.signals.items()}
    at = np.arange(every, pins.end - 20, every)
    ticks = np.concatenate([[0], np.column_stack([at, at + 1]).ravel()])
    inputs["strobe"] = Waveform.of(ticks, np.arange(ticks.size) & 1)
    outputs = Model(CONFIG).advance(pins.end, Trace(inputs, pins.period, 0, pins.end))
    shots, axle = snapshots(outputs, CONFIG)[::keep], Axle(CONFIG, ASSUMED)
    return np.array([s.time for s in shots]) / CONFIG.clock_hz, [axle.update(s) for s in shots]


def flagged(told: list[Estimate], flag: str) -> np.ndarray:
    return np.array([flag in estimate.flags for estimate in told])


STOP = line((0, 80), (10, 80), (30, 0), (36, 0))
"""Braking at 1.11 m/s², then six seconds of rest."""


@pytest.mark.parametrize("keep", [1, 3])
@pytest.mark.parametrize("profile", [STOP, run(70, 60), line((0, 0), (4, 0), (14, 50), (24, 3))])
def test_both_bounds_hold_the_speed_all_the_way(profile: Profile, keep: int) -> None:
    """Also where two of three replies are lost."""
    times, told = tracked(profile, Sensor(), keep)
    truth = np.abs(profile.speed_kmh(times))
    assert all(t.low_kmh <= v <= t.high_kmh for t, v in zip(told, truth, strict=True))
    assert all(t.high_kmh > 0 for t in told)
    assert not flagged(told, "slide_or_lost").any()
    width = np.array([t.high_kmh - t.low_kmh for t in told])
    assert (width[times > 1] < 1.2).all()


def test_a_wheel_is_called_still_at_rest_and_only_after_two_seconds() -> None:
    times, told = tracked(STOP, Sensor())
    still = times[flagged(told, "wheel_standstill")]
    assert (np.diff(still) < 1.5 * WINDOW_S).all()
    assert still[-1] == times[-1]
    assert 31.5 < still[0] < 32.1
    assert told[-1].high_kmh < SATURATED_KMH


def test_a_lost_sensor_is_flagged_and_stays_so() -> None:
    times, told = tracked(line((0, 30), (20, 30)), Sensor(a_dead_s=2.0, b_dead_s=2.0))
    lost = flagged(told, "slide_or_lost")
    assert not lost[times < 2].any()
    assert lost[times > 2.1].all()
    assert told[-1].flags == ("slide_or_lost", "wheel_standstill")
    assert told[-1].high_kmh < SATURATED_KMH


def test_where_the_wheel_locks_the_bound_falls_as_the_train_brakes_at_most() -> None:
    """Locked from 5 s on, the train braking at a_max all the while, rolling again at 9 s."""
    dead, braked = 5.0, 80 - 3.6 * 1.5 * 4
    wheel = line((0, 80), (dead, 80), (dead + 0.001, 0), (9, 0), (9.001, braked), (12, braked))
    times, told = tracked(wheel, Sensor())
    train = np.interp(times, [0, 5, 9, 12], [80, 80, braked, braked])
    high = np.array([t.high_kmh for t in told])
    locked, slid = (times > 5.1) & (times < 9), flagged(told, "slide_or_lost")
    assert slid[locked].all()
    assert not slid[(times < dead) | (times > 9.1)].any()
    assert (high >= train)[times < 9].all()
    assert (high - train)[locked].max() < 1
    assert np.diff(high[locked]) / WINDOW_S / 3.6 == pytest.approx(-1.5, rel=1e-3)
    assert (high >= braked)[times > 9.1].all()


def test_a_spinning_wheel_raises_only_the_upper_bound() -> None:
    spin = line((0, 20), (5, 20), (5.2, 60), (6, 60), (6.2, 20), (8, 20))
    times, told = tracked(spin, Sensor())
    wheel = spin.speed_kmh(times)
    during = (times > 5.25) & (times < 6)
    assert all(t.high_kmh >= v for t, v, on in zip(told, wheel, during, strict=True) if on)
    assert all(t.low_kmh <= 20.2 for t in told)
    assert flagged(told, "spin")[during].all()
    assert not flagged(told, "spin")[(times < 5) | (times > 6.3)].any()
    assert not flagged(told, "slide_or_lost").any()
    assert told[-1].high_kmh < 20.5


def test_what_does_not_fit_is_refused() -> None:
    with pytest.raises(ValueError, match="standstill_s must be above 0 and at most 268"):
        Axle(CONFIG, ASSUMED, standstill_s=300)
