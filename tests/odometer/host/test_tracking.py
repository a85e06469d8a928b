"""Trains whose truth is known, through sensors and model to the bounds of axle and train."""

import numpy as np
import pytest

from railgate.odometer.host.readout import Snapshot, snapshots
from railgate.odometer.host.tracking import Axle, Train, TrainSpeed
from railgate.odometer.model import Model
from railgate.odometer.plant import Profile, Sensor, run
from railgate.odometer.spec import Assumptions, Config
from railgate.waves import Trace, Waveform

pytestmark = pytest.mark.shows("ODO-11")

CONFIG = Config()
ASSUMED = Assumptions(crystal_ppm=10)
WINDOW_S = 0.02
SATURATED_KMH = 0.64
"""Where the bound of silence ends: √(2 · pitch · acceleration_max)."""


def line(*points: tuple[float, float]) -> Profile:
    """From points of time, s, and speed, km/h."""
    times, speeds = zip(*points, strict=True)
    return Profile(np.array(times), np.array(speeds) / 3.6)


def played(profile: Profile, *sensors: Sensor) -> list[list[Snapshot]]:
    """The snapshots of each strobe, an axle after the other."""
    config = Config(sensors=len(sensors))
    every = round(WINDOW_S * config.clock_hz)
    inputs = {}
    for i, sensor in enumerate(sensors):
        pins = sensor.drive(profile, config)
        inputs |= {f"sensor.{i}.{name}": wave for name, wave in pins.signals.items()}
    at = np.arange(every, pins.end - 20, every)
    ticks = np.concatenate([[0], np.column_stack([at, at + 1]).ravel()])
    inputs["strobe"] = Waveform.of(ticks, np.arange(ticks.size) & 1)
    outputs = Model(config).advance(pins.end, Trace(inputs, pins.period, 0, pins.end))
    of_each = [snapshots(outputs, config, i) for i in range(len(sensors))]
    return [list(shots) for shots in zip(*of_each, strict=True)]


def tracked(shots: list[list[Snapshot]]) -> tuple[np.ndarray, list[TrainSpeed]]:
    """Strobe times, s, and what the train's tracking says."""
    train = Train(CONFIG, ASSUMED, axles=len(shots[0]))
    told = [train.update(strobe) for strobe in shots]
    return np.array([strobe[0].time / CONFIG.clock_hz for strobe in shots]), told


STOP = line((0, 80), (10, 80), (30, 0), (36, 0))
"""Braking at 1.11 m/s², then six seconds of rest."""


@pytest.mark.parametrize("keep", [1, 3])
@pytest.mark.parametrize("profile", [STOP, run(70, 60), line((0, 0), (4, 0), (14, 50), (24, 3))])
def test_both_bounds_hold_the_speed_all_the_way(profile: Profile, keep: int) -> None:
    """Also where two of three replies are lost."""
    shots = played(profile, Sensor(), Sensor(offset=0.6))[::keep]
    times, told = tracked(shots)
    truth = np.abs(profile.speed_kmh(times))
    assert all(t.low_kmh <= v <= t.high_kmh for t, v in zip(told, truth, strict=True))
    assert all(t.high_kmh > 0 for t in told)
    assert not any("slide_or_lost" in axle.flags for t in told for axle in t.axles)
    width = np.array([t.high_kmh - t.low_kmh for t in told])
    assert (width[times > 1] < 1.2).all()


def test_standstill_is_claimed_of_a_train_at_rest_and_only_after_two_seconds() -> None:
    times, told = tracked(played(STOP, Sensor(), Sensor(offset=0.6)))
    still = times[[t.standstill for t in told]]
    assert (np.diff(still) < 1.5 * WINDOW_S).all()
    assert still[-1] == times[-1]
    assert 31.5 < still[0] < 32.1
    assert told[-1].high_kmh < SATURATED_KMH


def test_one_axle_alone_never_claims_the_train_at_rest() -> None:
    _, told = tracked(played(STOP, Sensor()))
    assert told[-1].axles[0].flags == ("wheel_standstill",)
    assert not any(t.standstill for t in told)


def test_one_lost_sensor_is_flagged_and_the_other_axle_still_bounds_the_train() -> None:
    shots = played(STOP, Sensor(), Sensor(offset=0.6, a_dead_s=5, b_dead_s=5))
    times, told = tracked(shots)
    truth = STOP.speed_kmh(times)
    lost = np.array(["slide_or_lost" in t.axles[1].flags for t in told])
    assert not lost[times < 5].any()
    assert lost[times > 5.06].all()
    assert all(t.high_kmh >= v for t, v in zip(told, truth, strict=True))
    assert not any(t.standstill for t in told)


def test_where_both_axles_lock_the_bound_falls_as_the_train_brakes_at_most() -> None:
    """Wheels locked from 5 s on, the train braking at a_max all the while, rolling again at 9 s."""
    dead, braked = 5.0, 80 - 3.6 * 1.5 * 4
    wheel = line((0, 80), (dead, 80), (dead + 0.001, 0), (9, 0), (9.001, braked), (12, braked))
    times, told = tracked(played(wheel, Sensor(), Sensor(offset=0.6)))
    train = np.interp(times, [0, 5, 9, 12], [80, 80, braked, braked])
    high = np.array([t.high_kmh for t in told])
    locked = (times > 5.1) & (times < 9)
    flagged = np.array(["slide_or_lost" in t.axles[0].flags for t in told])
    assert flagged[locked].all()
    assert not flagged[times < dead].any()
    assert not flagged[times > 9.1].any()
    assert (high >= train)[times < 9].all()
    assert (high - train)[locked].max() < 1
    fall = np.diff(high[locked]) / WINDOW_S / 3.6
    assert fall == pytest.approx(-1.5, rel=1e-3)
    assert (high >= braked)[times > 9.1].all()
    assert not any(t.standstill for t in told)


def test_sensors_lost_at_speed_never_become_a_train_at_rest() -> None:
    cut = {"a_dead_s": 2.0, "b_dead_s": 2.0}
    shots = played(line((0, 30), (20, 30)), Sensor(**cut), Sensor(offset=0.6, **cut))
    times, told = tracked(shots)
    assert told[-1].high_kmh < SATURATED_KMH
    assert times[-1] > 19
    assert not any(t.standstill for t in told)
    assert told[-1].axles[0].flags == ("slide_or_lost", "wheel_standstill")


def test_a_spinning_wheel_raises_only_the_upper_bound() -> None:
    spin = line((0, 20), (5, 20), (5.2, 60), (6, 60), (6.2, 20), (8, 20))
    times, told = tracked(played(spin, Sensor()))
    wheel = spin.speed_kmh(times)
    during = (times > 5.25) & (times < 6)
    assert all(t.high_kmh >= v for t, v, on in zip(told, wheel, during, strict=True) if on)
    assert all(t.low_kmh <= 20.2 for t in told)
    flagged = np.array(["spin" in t.axles[0].flags for t in told])
    assert flagged[during].all()
    assert not flagged[(times < 5) | (times > 6.3)].any()
    assert not any("slide_or_lost" in t.axles[0].flags for t in told)
    assert told[-1].high_kmh < 20.5


def test_what_does_not_fit_is_refused() -> None:
    with pytest.raises(ValueError, match="standstill_s must be above 0 and at most 268"):
        Axle(CONFIG, ASSUMED, standstill_s=300)
    with pytest.raises(ValueError, match="axles must be at least 1, not 0"):
        Train(CONFIG, ASSUMED, axles=0)
    shots = played(line((0, 30), (0.1, 30)), Sensor(), Sensor())
    with pytest.raises(ValueError, match="a strobe needs 2 snapshots, one an axle, not 1"):
        Train(CONFIG, ASSUMED).update(shots[0][:1])
    with pytest.raises(ValueError, match="of one strobe"):
        Train(CONFIG, ASSUMED).update([shots[0][0], shots[1][1]])
