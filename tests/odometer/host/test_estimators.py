"""Every interval holds the truth, comes near it somewhere, and the values are exact."""

import math
from collections.abc import Sequence
from dataclasses import fields, replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from railgate.odometer.host.estimators import (
    Scale,
    least_squares,
    one_period,
    present,
    reciprocal,
    weighted_paces,
)
from railgate.odometer.host.readout import Snapshot
from railgate.odometer.spec import Assumptions, Config

pytestmark = pytest.mark.shows("ODO-14")

CONFIG = Config()
BLANK = Snapshot(**dict.fromkeys((field.name for field in fields(Snapshot)), 0))
TICK_ONLY = Scale(CONFIG, Assumptions(crystal_ppm=0))


def crossing(place: float, speed: float, acceleration: float) -> float:
    """When a wheel that is at 0 at time 0 reaches `place`; pitches and ticks."""
    return 2 * place / (speed + math.sqrt(speed**2 + 2 * acceleration * place))


def reading(times: Sequence[float], strobe: int = 0) -> Snapshot:
    """The window of rising edges at true times, in ticks, behind the input's delay."""
    stamps = [math.ceil(time) + CONFIG.input_delay_ticks for time in times]
    passed = [stamp - stamps[0] for stamp in stamps]
    n = len(stamps) - 1
    return replace(
        BLANK,
        period=stamps[-1] - stamps[-2],
        period_valid=1,
        since_rise=max(strobe - stamps[-1], 0),
        window_seated=1,
        window_n=n,
        window_ticks=passed[-1],
        sum_a=sum(passed),
        sum_b=sum((n + 1 - k) * t for k, t in enumerate(passed)),
    )


@st.composite
def wheels(draw: st.DrawFn, tooth_most: float = 0.05) -> tuple[Scale, float, float, list[float]]:
    """A scale that holds, true speed (km/h) at place 0 and acceleration, teeth off their places."""
    assumed = Assumptions(
        crystal_ppm=draw(st.sampled_from([0.0, 100.0])),
        diameter_tolerance_m=draw(st.sampled_from([0.0, 0.005])),
        tooth_error=draw(st.sampled_from([0.0, tooth_most])),
    )
    n = draw(st.integers(1, 110))
    teeth = st.floats(-assumed.tooth_error, assumed.tooth_error)
    places = draw(st.lists(teeth, min_size=n + 1, max_size=n + 1))
    acceleration = draw(st.floats(-1, 1)) * assumed.acceleration_max
    return Scale(CONFIG, assumed), draw(st.floats(3, 220)), acceleration, places


def truth(
    draw: st.DataObject, scale: Scale, speed_kmh: float, acceleration: float
) -> tuple[float, float, float]:
    """km/h at 1 pitch per true tick, and speed and acceleration in pitches and true ticks."""
    assumed = scale.assumptions
    ppm = draw.draw(st.sampled_from([-1, 0, 1])) * assumed.crystal_ppm * 1e-6
    wider = draw.draw(st.sampled_from([-1, 0, 1])) * assumed.diameter_tolerance_m
    hz = CONFIG.clock_hz * (1 + ppm)
    pitch = math.pi * (float(CONFIG.wheel_diameter_m) + wider) / CONFIG.pulses_per_rev
    unit = 3.6 * pitch * hz
    return unit, speed_kmh / unit, acceleration / pitch / hz**2


@given(wheels(), st.floats(0, 1), st.data())
@settings(deadline=None)
def test_pi_and_one_period_hold_the_mean_speed(
    wheel: tuple[Scale, float, float, list[float]], phase: float, data: st.DataObject
) -> None:
    scale, speed_kmh, acceleration, teeth = wheel
    unit, speed, a = truth(data, scale, speed_kmh, acceleration)
    places = [k + phase + 0.1 + tooth for k, tooth in enumerate(teeth)]
    assume(speed**2 + 2 * min(a, 0) * places[-1] > 0)
    times = [crossing(place, speed, a) for place in places]
    snapshot = reading(times)
    for estimate, first in ((reciprocal(snapshot, scale), 0), (one_period(snapshot, scale), -2)):
        mean = unit * (places[-1] - places[first]) / (times[-1] - times[first])
        assert estimate.low_kmh < mean < estimate.high_kmh
        assert estimate.value_kmh is not None
        assert estimate.low_kmh < estimate.value_kmh < estimate.high_kmh


@given(wheels(), st.floats(0, 1), st.data())
@settings(deadline=None)
def test_omega_holds_the_weighted_mean_of_the_periods(
    wheel: tuple[Scale, float, float, list[float]], phase: float, data: st.DataObject
) -> None:
    scale, speed_kmh, acceleration, teeth = wheel
    unit, speed, a = truth(data, scale, speed_kmh, acceleration)
    n = len(teeth) - 1
    assume(speed**2 + 2 * min(a, 0) * (n + 2) > 0)
    times = [crossing(k + phase + 0.1 + tooth, speed, a) for k, tooth in enumerate(teeth)]
    ideal = [Fraction(crossing(k + phase + 0.1, speed, a)) for k in range(n + 1)]
    pace = sum(Fraction(12 * k - 6 * n, n * (n + 1) * (n + 2)) * t for k, t in enumerate(ideal))
    estimate = least_squares(reading(times), scale)
    assert estimate.low_kmh < unit / float(pace) < estimate.high_kmh


def late(n: int, which: Sequence[bool], period: float = 3000.0) -> list[float]:
    """Edges stamped k · period, those of `which` met almost a tick before that."""
    return [k * period - (1 - 1e-6 if which[k] else 0) for k in range(n + 1)]


@pytest.mark.parametrize("n", [1, 2, 3, 10, 109, 110])
def test_pi_comes_within_a_millionth_of_its_bounds(n: int) -> None:
    for first, side in ((True, "low_kmh"), (False, "high_kmh")):
        times = late(n, [first, *[False] * (n - 1), not first])
        bound = getattr(reciprocal(reading(times), TICK_ONLY), side)
        mean = TICK_ONLY.unit_kmh * n / (times[-1] - times[0])
        assert abs(TICK_ONLY.unit_kmh * n / bound - (times[-1] - times[0])) < 3e-6, mean


@pytest.mark.parametrize("n", [1, 2, 3, 10, 109, 110])
def test_omega_comes_within_a_millionth_of_its_bounds(n: int) -> None:
    weights = [(12 * k - 6 * n) / (n * (n + 1) * (n + 2)) for k in range(n + 1)]
    for sign, side in ((1, "high_kmh"), (-1, "low_kmh")):
        times = late(n, [sign * weight > 0 for weight in weights])
        estimate = least_squares(reading(times), TICK_ONLY)
        pace = sum(weight * time for weight, time in zip(weights, times, strict=True))
        assert abs(TICK_ONLY.unit_kmh / getattr(estimate, side) - pace) < 3e-6


@pytest.mark.parametrize("n", [2, 9, 50])
def test_omega_with_tooth_error_comes_near_its_bounds(n: int) -> None:
    tooth, period = 0.05, 3000.0
    weights = [(12 * k - 6 * n) / (n * (n + 1) * (n + 2)) for k in range(n + 1)]
    times = [(k + math.copysign(tooth, w)) * period for k, w in enumerate(weights)]
    scale = Scale(CONFIG, Assumptions(crystal_ppm=0, tooth_error=tooth))
    snapshot = reading(times)
    pace = sum(w * math.ceil(t) for w, t in zip(weights, times, strict=True))
    low, _ = weighted_paces(n, snapshot.window_ticks, pace, tooth, scale.acceleration)
    assert low < period < low + 0.02 * (pace - low) + 2


@pytest.mark.shows("ODO-10")
def test_omega_is_the_exact_least_squares_slope_whatever_the_size() -> None:
    rng = np.random.default_rng(1)
    for n in (1, 2, 7, 110, 8191):
        times = np.cumsum(rng.integers(400_000, 500_000, n + 1)).tolist()
        mean = Fraction(sum(times), n + 1)
        top = sum((k - Fraction(n, 2)) * (t - mean) for k, t in enumerate(times))
        slope = top / Fraction(n * (n + 1) * (n + 2), 12)
        value = least_squares(reading(times), TICK_ONLY).value_kmh
        assert value == TICK_ONLY.unit_kmh / float(slope)


@pytest.mark.parametrize("n", [1, 5, 40])
def test_the_values_scatter_as_their_standard_deviation_says(n: int) -> None:
    rng = np.random.default_rng(n)
    for estimator in (reciprocal, least_squares):
        ratios = []
        for period, phase in zip(rng.uniform(2900, 3100, 3000), rng.random(3000), strict=True):
            estimate = estimator(reading((phase + np.arange(n + 1) * period).tolist()), TICK_ONLY)
            assert estimate.value_kmh is not None
            assert estimate.std_kmh is not None
            error = estimate.value_kmh - TICK_ONLY.unit_kmh / period
            ratios.append(error / estimate.std_kmh)
        assert 0.94 < np.std(ratios) < 1.06


def test_without_a_measurement_there_is_no_value() -> None:
    nothing = replace(BLANK, since_rise=16_000_000, since_edge=16_000_000)
    for estimator in (one_period, reciprocal, least_squares, present):
        estimate = estimator(nothing, TICK_ONLY)
        assert (estimate.value_kmh, estimate.std_kmh, estimate.low_kmh) == (None, None, 0.0)
        assert 0 < estimate.high_kmh < 0.7
    assert one_period(replace(nothing, period=3000), TICK_ONLY).value_kmh is None
    assert present(BLANK, TICK_ONLY).high_kmh == math.inf


@pytest.mark.shows("ODO-11")
@given(st.floats(0, 0.9999), st.floats(-1, 1), st.floats(0.001, 3))
@settings(deadline=None)
def test_silence_bounds_the_speed_now(way: float, share: float, quiet_s: float) -> None:
    """Any wheel at constant acceleration that stayed within a pitch for so long."""
    a = share * TICK_ONLY.assumptions.acceleration_max
    speed = way * CONFIG.pitch_m / quiet_s + a * quiet_s / 2
    ago = np.linspace(0, quiet_s, 2000)
    assume(np.ptp(speed * ago - a * ago**2 / 2) < CONFIG.pitch_m * 0.99995)
    snapshot = replace(BLANK, since_rise=int(quiet_s * CONFIG.clock_hz))
    assert 3.6 * abs(speed) < present(snapshot, TICK_ONLY).high_kmh


@pytest.mark.shows("ODO-11")
@pytest.mark.parametrize("quiet_s", [0.01, 0.05, 0.1, 10.0])
def test_the_bound_of_silence_is_met_by_the_wheel_that_starts_hardest(quiet_s: float) -> None:
    a = TICK_ONLY.assumptions.acceleration_max
    rise_s = min(quiet_s, math.sqrt(2 * CONFIG.pitch_m / a))
    now = CONFIG.pitch_m / rise_s + a * rise_s / 2
    snapshot = replace(BLANK, since_rise=int(quiet_s * CONFIG.clock_hz))
    assert 3.6 * now < present(snapshot, TICK_ONLY).high_kmh < 3.6 * now * 1.001


@given(wheels(), st.floats(0, 1), st.floats(0, 1), st.data())
@settings(deadline=None)
def test_the_interval_at_the_strobe_holds_the_speed_then(
    wheel: tuple[Scale, float, float, list[float]],
    phase: float,
    part: float,
    data: st.DataObject,
) -> None:
    scale, speed_kmh, acceleration, teeth = wheel
    unit, speed, a = truth(data, scale, speed_kmh, acceleration)
    n = len(teeth) - 1
    assume(speed**2 + 2 * min(a, 0) * (n + 3) > 0)
    times = [crossing(k + phase + 0.1 + tooth, speed, a) for k, tooth in enumerate(teeth)]
    following = crossing(n + 1 + phase + 0.1 - scale.assumptions.tooth_error, speed, a)
    now = max(times[-1], times[-1] + part * (following - times[-1]))
    strobe = math.ceil(now) + CONFIG.input_delay_ticks
    interval = present(reading(times, strobe), scale)
    then = unit * (speed + a * strobe)
    assert interval.value_kmh is None
    assert interval.low_kmh < then < interval.high_kmh


def test_the_interval_at_the_strobe_is_no_wider_than_the_window_and_a_max_make_it() -> None:
    times = [k * CONFIG.period_ticks(200) for k in range(101)]
    interval = present(reading(times, math.ceil(times[-1]) + 1000), TICK_ONLY)
    most = 3.6 * 1.5 * (times[-1] + 1000) / CONFIG.clock_hz + 2 * 200 / times[-1]
    assert 0 < 200 - interval.low_kmh < 1.001 * most
    assert 0 < interval.high_kmh - 200 < 1.001 * most


def test_a_wheel_that_changes_its_speed_faster_is_infeasible_at_the_strobe() -> None:
    slowing = replace(reading([k * 3000.0 for k in range(101)], 310_000), period=20_000)
    interval = present(slowing, TICK_ONLY)
    assert interval.flags == ("contradiction",)
    assert interval.low_kmh < 30 < 195 < interval.high_kmh


def test_a_tolerance_as_great_as_the_wheel_is_refused() -> None:
    small = Config(wheel_diameter_m=Fraction(1, 20), pulses_per_rev=10)
    with pytest.raises(ValueError, match=r"diameter_tolerance_m must be below the diameter, 0\.05"):
        Scale(small, Assumptions(diameter_tolerance_m=0.05))
