"""The configuration: the source's figures, derived widths, and what it refuses."""

from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from railgate.odometer.spec import STATE, Assumptions, Config, Flag

CONFIG = Config()


@pytest.mark.shows("ODO-1")
def test_200_kmh_is_5441_hz_of_16_mhz() -> None:
    assert 16e6 / CONFIG.period_ticks(200) == pytest.approx(5441, abs=0.5)


@pytest.mark.shows("ODO-6")
def test_a_32_bit_count_at_6_khz_overflows_after_715_827_s() -> None:
    width = next(field.width for field in CONFIG.sensor_fields if field.name == "pulses")
    assert (2**width - 1) // 6000 == 715_827


@pytest.mark.shows("ODO-10")
@given(st.integers(1, 5000), st.integers(18, 36))
def test_the_sums_of_the_longest_window_just_fit(periods: int, period_bits: int) -> None:
    config = Config(window_pulses=periods, period_bits=period_bits)
    sum_a = periods * config.period_max  # no t_k is longer than period_max
    sum_b = sum((k + 1) * config.period_max for k in range(periods))
    assert 2 ** (config.sum_a_bits - 1) <= sum_a < 2**config.sum_a_bits
    assert 2 ** (config.sum_b_bits - 1) <= sum_b < 2**config.sum_b_bits


def test_fields_have_names_of_their_own_and_the_state_is_among_them() -> None:
    names = [field.name for field in (*CONFIG.common_fields, *CONFIG.sensor_fields)]
    assert len(set(names)) == len(names)
    assert set(STATE) <= set(names)
    assert names[-1] == "flags"
    assert CONFIG.sensor_fields[-1].width == max(Flag).bit_length()


@pytest.mark.shows("ODO-9")
@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"clock_hz": 0}, "clock_hz must be between 1000 and 10000000000, not 0"),
        ({"sensors": 0}, "sensors must be between 1 and 16, not 0"),
        ({"filter_ticks": 65_536}, "filter_ticks must be between 0 and 65535, not 65536"),
        ({"filter_ticks": 1336}, "shortest half-period at overspeed, at most 1335, not 1336"),
        ({"minimum_kmh": Fraction(220)}, "minimum_kmh must be below overspeed_kmh, 220, not 220"),
        ({"period_bits": 17}, "period_bits must hold the period at minimum_kmh, at least 18"),
        ({"window_pulses": 2**20}, "must leave the Ω sums at most 64 bits, not"),
        ({"clock_hz": 20_000}, "at least 8 ticks of clock_hz, not 3"),
    ],
)
def test_a_configuration_that_cannot_hold_is_refused(given: dict[str, Any], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        Config(**given)


@pytest.mark.shows("ODO-9")
def test_the_longest_filter_that_spares_a_half_period_is_allowed() -> None:
    assert Config(filter_ticks=1335).input_delay_ticks == 1338


@pytest.mark.parametrize("name", ["crystal_ppm", "tooth_error", "jerk_max"])
def test_an_assumption_below_zero_is_refused(name: str) -> None:
    with pytest.raises(ValueError, match=f"{name} must be between 0"):
        Assumptions(**{name: -1})
