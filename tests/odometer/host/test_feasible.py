"""The feasible set: it holds the truth, is the whole truth, and says when there is none."""

import itertools
import math
from fractions import Fraction
from importlib import import_module

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from railgate.odometer.host.estimators import Scale, mean_speed
from railgate.odometer.host.feasible import feasible, speed_bounds
from railgate.odometer.spec import Assumptions, Config
from railgate.waves.waveform import Ticks

pytestmark = pytest.mark.shows("ODO-14")

module = import_module("railgate.odometer.host.feasible")  # the package has a function of that name

CONFIG = Config()
TICK_ONLY = Scale(CONFIG, Assumptions(crystal_ppm=0))
SPEEDS = st.floats(5, 220)


def trajectory(
    scale: Scale, speed_kmh: float, acceleration: float, places: list[float], jerk: float = 0.0
) -> tuple[Ticks, float]:
    """Stamps of a wheel that is at 0 at time 0, and its speed (km/h) at the window's middle.

    acceleration, m/s², is that at the middle, jerk, m/s³, constant. Clock and wheel are true.
    """
    unit = CONFIG.pitch_m * CONFIG.clock_hz
    v, a, j = (
        speed_kmh / 3.6 / unit,
        acceleration / unit / CONFIG.clock_hz,
        jerk / unit / CONFIG.clock_hz**2,
    )
    middle = places[-1] / 2 / v
    x, times = np.array(places), np.array(places) / v
    for _ in range(8):
        tau = times - middle
        at = v * times + a / 2 * (tau**2 - middle**2) + j / 6 * (tau**3 + middle**3)
        times = times - (at - x) / (v + a * tau + j / 2 * tau**2)
    stamps = np.ceil(times).astype(np.int64)
    tau = (stamps[0] + stamps[-1] - 1) / 2 - middle
    return stamps, scale.unit_kmh * (v + a * tau + j / 2 * tau**2)


@st.composite
def windows(draw: st.DrawFn) -> tuple[Scale, Ticks, float]:
    assumed = Assumptions(
        crystal_ppm=0,
        tooth_error=draw(st.sampled_from([0.0, 0.001, 0.05])),
        acceleration_max=draw(st.sampled_from([0.3, 1.5])),
        jerk_max=draw(st.sampled_from([0.0, 1.0])),
    )
    n = draw(st.integers(1, 110))
    seed = np.random.default_rng(draw(st.integers(0, 2**32)))
    teeth = seed.uniform(-1, 1, n + 1) * assumed.tooth_error
    places = (np.arange(n + 1) + 0.1 + seed.random() + teeth).tolist()
    jerk = draw(st.floats(-1, 1)) * assumed.jerk_max
    acceleration, speed_kmh = draw(st.floats(-1, 1)) * assumed.acceleration_max, draw(SPEEDS)
    lasts_s = (n + 2) * CONFIG.pitch_m * 3.6 / speed_kmh
    assume((abs(acceleration) + abs(jerk) * lasts_s) * lasts_s < 0.8 * speed_kmh / 3.6)
    # The window's middle is a little beside that of the trajectory.
    assume(abs(acceleration) + abs(jerk) * lasts_s / 3 <= assumed.acceleration_max)
    scale = Scale(CONFIG, assumed)
    stamps, middle_kmh = trajectory(scale, speed_kmh, acceleration, places, jerk)
    return scale, stamps, middle_kmh


@given(windows())
@settings(max_examples=400, deadline=None)
def test_it_holds_the_speed_at_the_middle(window: tuple[Scale, Ticks, float]) -> None:
    scale, stamps, middle_kmh = window
    estimate = feasible(stamps, scale)
    assert estimate.flags == ()
    slack = 1e-12 * middle_kmh
    assert estimate.low_kmh - slack < middle_kmh < estimate.high_kmh + slack
    assert estimate.value_kmh is not None
    assert estimate.low_kmh < estimate.value_kmh < estimate.high_kmh


def every_vertex(
    stamps: Ticks, tooth: Fraction, acceleration: Fraction
) -> tuple[Fraction, Fraction] | None:
    """The least and greatest speed at the middle over all vertices, in exact arithmetic."""
    middle = Fraction(int(stamps[0] + stamps[-1] - 1), 2)
    rows: list[tuple[list[Fraction], Fraction]] = []
    for k, stamp in enumerate(stamps.tolist()):
        early, late = stamp - 1 - middle, stamp - middle
        rows.append(([Fraction(1), early, early**2 / 2], k + tooth))
        rows.append(([Fraction(-1), -late, -(late**2) / 2], tooth - k))
    rows += [([Fraction(0), Fraction(0), Fraction(s)], acceleration) for s in (1, -1)]
    speeds = []
    for (p, b0), (q, b1), (r, b2) in itertools.combinations(rows, 3):
        cross = [q[1] * r[2] - q[2] * r[1], q[2] * r[0] - q[0] * r[2], q[0] * r[1] - q[1] * r[0]]
        det = sum(x * y for x, y in zip(p, cross, strict=True))
        if not det:
            continue
        columns = ([b0, b1, b2], *zip(p, q, r, strict=True))
        point = []
        for unknown in range(3):
            m = [columns[0] if i == unknown else columns[i + 1] for i in range(3)]
            top = (
                m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
                - m[1][0] * (m[0][1] * m[2][2] - m[0][2] * m[2][1])
                + m[2][0] * (m[0][1] * m[1][2] - m[0][2] * m[1][1])
            )
            point.append(top / det)
        if all(sum(x * y for x, y in zip(g, point, strict=True)) <= b for g, b in rows):
            speeds.append(point[1])
    return (min(speeds), max(speeds)) if speeds else None


@given(
    st.lists(st.integers(-2, 2), min_size=2, max_size=5),
    st.sampled_from([Fraction(0), Fraction(1, 1000)]),
    st.sampled_from([Fraction(1, 10**8), Fraction(1, 10**6), Fraction(1, 10**5)]),
)
@settings(max_examples=60, deadline=None)
def test_it_is_the_optimum_over_every_vertex(
    wobble: list[int], tooth: Fraction, acceleration: Fraction
) -> None:
    """As tight as an exhaustive search in exact arithmetic, and empty where that finds nothing."""
    stamps = np.array([300 * k + more for k, more in enumerate(wobble)], np.int64)
    expected = every_vertex(stamps, tooth, acceleration)
    low, high, empty = speed_bounds(stamps, float(tooth), float(acceleration), 0.0)
    assert empty == (expected is None)
    if expected is not None:
        assert low <= expected[0] * (1 + Fraction(1, 10**15))
        assert high >= expected[1] * (1 - Fraction(1, 10**15))
        assert low == pytest.approx(float(expected[0]), rel=1e-12)
        assert high == pytest.approx(float(expected[1]), rel=1e-12)


@pytest.mark.parametrize("speed_kmh", [5, 60, 200])
def test_of_one_period_it_says_what_pi_says(speed_kmh: float) -> None:
    stamps, _ = trajectory(TICK_ONLY, speed_kmh, 0.5, [0.3, 1.3])
    narrow = feasible(stamps, TICK_ONLY)
    plain = mean_speed(1, int(stamps[1] - stamps[0]), TICK_ONLY)
    assert narrow.low_kmh == pytest.approx(plain.low_kmh, rel=1e-9)
    assert narrow.high_kmh == pytest.approx(plain.high_kmh, rel=1e-9)


def test_at_200_kmh_it_is_over_ten_times_narrower_than_pi() -> None:
    rng = np.random.default_rng(3)
    ratios = []
    for phase in rng.random(200):
        stamps, _ = trajectory(TICK_ONLY, 200, 0, [phase + k for k in range(109)])
        narrow = feasible(stamps, TICK_ONLY)
        wide = mean_speed(108, int(stamps[-1] - stamps[0]), TICK_ONLY)
        ratios.append((narrow.high_kmh - narrow.low_kmh) / (wide.high_kmh - wide.low_kmh))
    assert np.mean(ratios) < 0.1


def test_stopping_early_costs_width_and_never_truth(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_greatest", module._greatest.py_func)
    stamps, middle_kmh = trajectory(TICK_ONLY, 150, 1.0, [0.4 + k for k in range(80)])
    widths = []
    for exchanges in range(1, 25):
        monkeypatch.setattr(module, "EXCHANGES", exchanges)
        low, high, empty = speed_bounds.py_func(stamps, 0.0, TICK_ONLY.acceleration, 0.0)
        assert not empty
        assert low <= middle_kmh / TICK_ONLY.unit_kmh <= high
        widths.append(high - low)
    assert widths == sorted(widths, reverse=True)
    assert widths[-1] < widths[0] / 4


def pi_but_flagged(stamps: Ticks) -> bool:
    estimate = feasible(stamps, TICK_ONLY)
    plain = mean_speed(stamps.size - 1, int(stamps[-1] - stamps[0]), TICK_ONLY)
    same = (estimate.value_kmh, estimate.low_kmh) == (plain.value_kmh, plain.low_kmh)
    return estimate.flags == ("infeasible",) and same and estimate.of == plain.of


def test_where_nothing_fits_it_is_pi_and_flagged() -> None:
    places = [0.3 + k for k in range(109)]
    fits, _ = trajectory(TICK_ONLY, 200, 1.45, places)
    assert not pi_but_flagged(fits)
    too_hard, _ = trajectory(TICK_ONLY, 200, 4.0, places)
    assert pi_but_flagged(too_hard)
    assert pi_but_flagged(np.delete(fits, 50))
    assert pi_but_flagged(np.sort(np.append(fits, fits[50] + 1000)))
    jerky, _ = trajectory(TICK_ONLY, 200, 0.0, places, jerk=1000.0)
    assert pi_but_flagged(jerky)


def test_an_edge_alone_is_refused() -> None:
    with pytest.raises(ValueError, match="at least 2 edges, not 1"):
        feasible(np.array([5]), TICK_ONLY)
    assert math.isfinite(feasible(np.array([5, 13]), TICK_ONLY).high_kmh)
