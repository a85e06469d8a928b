"""From a run's registers to a wheel's speed: each estimator holds what it says it holds."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from railgate.odometer import host
from railgate.odometer.host import ESTIMATORS, Estimate, Snapshot, Stamps, Wheel
from railgate.odometer.model import Model
from railgate.odometer.plant import Profile, Sensor, constant
from railgate.odometer.spec import Assumptions, Config
from railgate.waves import Trace, Waveform

pytestmark = pytest.mark.shows("ODO-14")

CONFIG = Config(sensors=1, stamp_depth=64)
EVERY_TICKS = 320_000
BRAKING = Profile(np.array([0.0, 12.0, 14.5]), np.array([60, 0, 0]) / 3.6)
TEETH = 0.01


def played(profile: Profile, sensor: Sensor) -> tuple[list[Snapshot], Stamps]:
    pins = sensor.drive(profile, CONFIG)
    at = np.arange(EVERY_TICKS, pins.end - 20, EVERY_TICKS)
    ticks = np.concatenate([[0], np.column_stack([at, at + 1]).ravel()])
    inputs = {f"sensor.0.{name}": wave for name, wave in pins.signals.items()}
    inputs["strobe"] = Waveform.of(ticks, np.arange(ticks.size) & 1)
    inputs["sensor.0.stamps.ready"] = Waveform.of([0], [1])
    outputs = Model(CONFIG).advance(pins.end, Trace(inputs, pins.period, 0, pins.end))
    return host.snapshots(outputs, CONFIG), host.stamps(outputs, CONFIG)


def told(
    name: str, shots: list[Snapshot], stamps: Stamps | None, assumed: Assumptions
) -> list[Estimate]:
    wheel = Wheel(CONFIG, assumed, name)
    return [wheel.update(shot, stamps) for shot in shots]


@pytest.mark.parametrize("name", ESTIMATORS)
@pytest.mark.parametrize("teeth", [0.0, TEETH])
def test_every_estimator_holds_the_speed_of_a_braking_train(name: str, teeth: float) -> None:
    """Each instant of a window counts as truth: what is held is a mean over it or its middle."""
    shots, stamps = played(BRAKING, Sensor(tooth_error=teeth))
    assumed = Assumptions(crystal_ppm=0, tooth_error=teeth)
    estimates = told(name, shots, stamps, assumed)
    measured = 0
    for estimate, shot in zip(estimates, shots, strict=True):
        now_s = shot.time / CONFIG.clock_hz
        if estimate.value_kmh is None:
            first_s = now_s
        else:
            ticks = shot.period if name == "period" else shot.window_ticks
            first_s = (shot.time - shot.since_rise - ticks) / CONFIG.clock_hz
            measured += 1
        most, least = BRAKING.speed_kmh(np.array([first_s, now_s]))
        assert estimate.low_kmh <= most
        assert estimate.high_kmh >= least
        assert estimate.high_kmh > 0
        assert estimate.flags in ((), ("wheel_standstill",), ("contradiction",))
    assert measured > 500
    assert estimates[-1].value_kmh is None
    assert estimates[-1].high_kmh < 0.65


def test_the_feasible_set_fits_a_real_run_and_is_the_narrowest() -> None:
    shots, stamps = played(constant(200, 0.5), Sensor())
    widths = {}
    for name in ESTIMATORS:
        estimates = told(name, shots, stamps, Assumptions(crystal_ppm=0))[1:]
        assert all(e.low_kmh < 200 < e.high_kmh and not e.flags for e in estimates)
        widths[name] = np.mean([e.high_kmh - e.low_kmh for e in estimates])
    assert widths["feasible"] < widths["omega"] < widths["period"]
    assert 10 * widths["feasible"] < widths["pi"] < widths["period"] / 50


def test_without_its_stamps_the_feasible_set_is_pi_and_says_so() -> None:
    shots, stamps = played(constant(100, 0.2), Sensor())
    assumed = Assumptions()
    for missing in (None, replace(stamps, lost=np.ones_like(stamps.lost))):
        estimates = told("feasible", shots, missing, assumed)
        plain = told("pi", shots, None, assumed)
        assert {e.flags for e in estimates} == {("stamps_missing",)}
        assert [replace(e, flags=()) for e in estimates] == plain


def test_a_stale_period_is_no_measurement() -> None:
    """The source's register keeps its last period while the train stands."""
    shots, _ = played(BRAKING, Sensor())
    estimates = told("period", shots, None, Assumptions())
    for estimate, (older, newer) in zip(estimates[1:], itertools.pairwise(shots), strict=True):
        assert (estimate.value_kmh is not None) == (newer.a_rising > older.a_rising)
    assert shots[-1].period_valid
    assert estimates[-1].flags == ("wheel_standstill",)


def test_a_wheel_needs_an_estimator_that_there_is() -> None:
    with pytest.raises(ValueError, match="one of period, pi, omega, feasible, not kalman"):
        Wheel(CONFIG, Assumptions(), "kalman")
