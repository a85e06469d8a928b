"""From pins to windows: counts, times, bounds, and one result from every engine."""

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.odometer.host import ESTIMATORS, period_bounds_kmh, phase_bounds_deg
from railgate.odometer.measure import Measurement, measure, part, stimulus
from railgate.odometer.plant import Profile, Sensor, constant, run, shuttle
from railgate.odometer.simulate import simulate
from railgate.odometer.spec import Assumptions, Config
from railgate.waves import Trace, Waveform, read

CAPTURES = Path(__file__).parents[1] / "data" / "sigrok"
FAST = CAPTURES / "avago_adns_2051_move_mouse_fast.sr"
CONFIG = Config(sensors=1)


def mouse() -> Trace:
    return read(FAST, ["XA", "XB"]).rename({"XA": "a", "XB": "b"})


def same(left: Measurement, right: Measurement) -> bool:
    return {**left.as_json(), "engine": ""} == {**right.as_json(), "engine": ""}


@pytest.mark.parametrize("filter_ticks", [0, 7, 300])
def test_a_window_holds_the_pin_changes_before_its_end_whatever_the_filter(filter_ticks) -> None:
    pins = Sensor().drive(constant(150, 0.2), CONFIG)
    measured = measure(pins, replace(CONFIG, filter_ticks=filter_ticks))
    rising = pins["a"].rising()
    ends = [round(window.t_s * 16e6) for window in measured.windows]
    assert ends == [320_000 * j for j in range(1, 11)]
    assert np.cumsum([w.pulses for w in measured.windows]).tolist() == [
        np.count_nonzero(rising < end) for end in ends
    ]


def test_the_last_window_ends_with_the_capture() -> None:
    measured = measure(mouse(), CONFIG, every_s=Fraction(300, 1000))
    assert [w.t_s for w in measured.windows][-2:] == pytest.approx([4.8, 5.0])
    assert measured.duration_s == 5.0


@pytest.mark.shows("ODO-6")
def test_counts_are_those_of_the_raw_channels() -> None:
    pins = mouse()
    measured = measure(pins, CONFIG)
    assert measured.a_rising == pins["a"].rising().size == sum(w.pulses for w in measured.windows)
    assert measured.b_rising == pins["b"].rising().size


@pytest.mark.shows("SYS-2")
@pytest.mark.parametrize("estimator", ["pi", "feasible"])
def test_every_engine_gives_the_same_result_to_the_bit(estimator: str) -> None:
    pins = part(mouse(), (Fraction(332, 1000), Fraction(352, 1000)))  # its busiest 20 ms
    config = replace(CONFIG, clock_hz=1_000_000)
    how = {"every_s": Fraction(12, 1000), "estimator": estimator}
    leap, cxxrtl, pysim = (
        measure(pins, config, engine=engine, **how) for engine in ("leap", "cxxrtl", "pysim")
    )
    assert any(window.speed_kmh is not None for window in leap.windows)
    assert same(leap, cxxrtl)
    assert same(leap, pysim)


def test_progress_is_told_and_changes_nothing() -> None:
    done: list[float] = []
    assert same(measure(mouse(), CONFIG), measure(mouse(), CONFIG, progress=done.append))
    assert done == sorted(done)
    assert done[-1] == 1


TICK_ONLY = Assumptions(crystal_ppm=0, jerk_max=0.2)
"""Nothing but the tick, so that no tolerance hides an error."""


@pytest.mark.shows("ODO-14")
@pytest.mark.parametrize("estimator", ESTIMATORS)
@pytest.mark.parametrize("course", [run(160, 160), constant(-90, 2), shuttle(20, 40)])
def test_the_truth_is_in_every_interval(course: Profile, estimator: str) -> None:
    measured = simulate(course, Sensor(), CONFIG, estimator=estimator, assumptions=TICK_ONLY)
    assert measured.truth_outside == 0
    assert any(window.speed_kmh is not None for window in measured.windows)


@pytest.mark.shows("ODO-14")
@pytest.mark.parametrize("estimator", ESTIMATORS)
@pytest.mark.parametrize("speed", [50, -50])
def test_the_truth_is_of_what_each_estimator_speaks_of(speed: float, estimator: str) -> None:
    how = {"every_s": Fraction(3, 10), "estimator": estimator, "assumptions": TICK_ONLY}
    course = run(speed, 60)
    measured = simulate(course, Sensor(), CONFIG, **how)
    assert measured.truth_outside == 0
    if estimator in ("omega", "feasible"):
        mean = simulate(course, Sensor(), CONFIG, **{**how, "estimator": "pi"})
        pairs = zip(measured.windows, mean.windows, strict=True)
        assert any(w.true_speed_kmh != m.true_speed_kmh for w, m in pairs)


@pytest.mark.shows("ODO-14")
@pytest.mark.parametrize("estimator", ESTIMATORS)
@pytest.mark.parametrize("sampled_hz", [1_000_000, 3_000_000, 24_000_000])
def test_a_capture_coarser_than_the_clock_widens_the_interval(sampled_hz, estimator) -> None:
    speed = 199.37
    pins = Sensor().drive(constant(speed, 0.5), replace(CONFIG, clock_hz=sampled_hz))
    exact = replace(TICK_ONLY, jerk_max=0.0)
    windows = measure(pins, CONFIG, estimator=estimator, assumptions=exact).windows[1:]
    assert not any("infeasible" in window.flags for window in windows)
    assert all(w.speed_low_kmh <= speed <= w.speed_high_kmh for w in windows)


@pytest.mark.shows("ODO-14")
@pytest.mark.parametrize("estimator", ESTIMATORS)
def test_the_truth_is_in_every_interval_with_tooth_error_assumed(estimator: str) -> None:
    sensor = Sensor(tooth_error=0.02, seed=3)
    course = run(120, 120)
    honest = Assumptions(tooth_error=0.02)
    assert (
        simulate(course, sensor, CONFIG, estimator=estimator, assumptions=honest).truth_outside == 0
    )
    naive = simulate(course, sensor, CONFIG, estimator=estimator)
    assert naive.truth_outside, "an error that is not assumed must show, or the test sees nothing"


@pytest.mark.shows("ODO-3")
@given(offset=st.floats(0, 1), speed=st.floats(20, 215))
@settings(max_examples=30)
def test_every_period_lies_in_the_sources_bounds_at_any_alignment(offset, speed) -> None:
    measured = simulate(constant(speed, 0.05), Sensor(offset=offset), CONFIG, estimator="period")
    low, high = period_bounds_kmh(speed, CONFIG)
    speeds = [w.speed_kmh for w in measured.windows if w.speed_kmh is not None]
    assert speeds
    assert low <= min(speeds) <= max(speeds) <= high


@pytest.mark.shows("ODO-4")
@given(offset=st.floats(0, 1), frequency=st.sampled_from([100, 1000, 2000, 4000, 6000]))
@settings(max_examples=30)
def test_every_phase_lies_in_the_sources_table_at_any_alignment(offset, frequency) -> None:
    config = replace(CONFIG, overspeed_kmh=Fraction(250))
    speed = 3.6 * config.pitch_m * frequency
    measured = simulate(constant(speed, 0.1), Sensor(offset=offset), config)
    low, high = phase_bounds_deg(frequency, config)
    phases = [w.phase_deg for w in measured.windows if w.phase_deg is not None]
    assert phases
    assert low <= min(phases) <= max(phases) <= high


@pytest.mark.shows("ODO-11")
def test_a_lost_sensor_neither_stops_the_train_nor_keeps_its_speed() -> None:
    course = constant(100, 4)
    dead = Sensor(a_dead_s=1.0, b_dead_s=1.0)
    windows = simulate(course, dead, CONFIG).windows
    after = [w for w in windows if w.t_s > 1.1]
    assert all(w.speed_kmh is None and "slide_or_lost" in w.flags for w in after)
    highs = [w.speed_high_kmh for w in after]
    falls = np.diff(highs) / 0.02 / 3.6
    assert np.allclose(falls, -1.5, rtol=1e-3)
    assert all("wheel_standstill" in w.flags for w in after if w.t_s > 3.1)
    assert all(w.speed_low_kmh <= w.speed_high_kmh for w in windows)


@pytest.mark.shows("ODO-12")
def test_a_dead_channel_is_named() -> None:
    windows = simulate(constant(100, 1), Sensor(b_dead_s=0.5), CONFIG).windows
    assert not any("b_missing" in w.flags for w in windows if w.t_s <= 0.5)
    assert all("b_missing" in w.flags for w in windows if w.t_s > 0.6)


@pytest.mark.shows("ODO-5")
def test_a_reversal_has_no_phantom_speed() -> None:
    measured = simulate(shuttle(10, 20), Sensor(), CONFIG)
    assert measured.position_x4 in (-1, 0, 1)
    assert measured.direction_changes == 1
    speeds = [(w.speed_kmh, w.true_speed_kmh) for w in measured.windows if w.speed_kmh is not None]
    assert all(speed == pytest.approx(true, rel=2e-3) for speed, true in speeds)


def test_a_slice_speaks_in_the_captures_time() -> None:
    pins = part(mouse(), (Fraction(1), Fraction(3, 2)))
    measured = measure(pins, CONFIG)
    assert measured.windows[0].t_s == pytest.approx(1.02)
    assert measured.duration_s == 0.5


def test_a_slice_outside_the_capture_is_refused() -> None:
    with pytest.raises(ValueError, match=r"inside the capture, 0 s..5 s, not 4 s..6 s"):
        part(mouse(), (Fraction(4), Fraction(6)))


def test_a_rest_too_short_for_a_snapshot_goes_to_the_last_window() -> None:
    pins = mouse().slice(0, 40_000)
    for rest, last in ((10, [640_000]), (16, [639_984, 640_000])):
        every = Fraction((640_000 - rest) // 2, 16_000_000)
        ends = [round(w.t_s * 16e6) for w in measure(pins, CONFIG, every_s=every).windows]
        assert ends == [(640_000 - rest) // 2, *last]


def test_a_long_window_holds_all_its_periods() -> None:
    measured = simulate(constant(200, 6), Sensor(), CONFIG, every_s=Fraction(3))
    assert [window.pulses for window in measured.windows] == pytest.approx([16323, 16323], abs=1)
    assert not any(window.flags for window in measured.windows)


def test_too_many_windows_are_refused() -> None:
    with pytest.raises(ValueError, match="at most 1000000 windows"):
        stimulus(mouse(), CONFIG, Fraction(1, 10**6))


def test_a_window_shorter_than_a_snapshot_is_refused() -> None:
    with pytest.raises(ValueError, match="at least 16 ticks"):
        stimulus(mouse(), CONFIG, Fraction(1, 10**7))


def test_a_capture_without_edges_is_no_error() -> None:
    flat = Waveform.of([0], [1])
    measured = measure(Trace({"a": flat, "b": flat}, Fraction(1, 10**6), 0, 100_000), CONFIG)
    assert measured.a_rising == measured.position_x4 == 0
    assert all(w.speed_kmh is None and w.direction == "none" for w in measured.windows)
