"""The source's figures, to their last digit."""

from decimal import ROUND_HALF_UP, Decimal
from fractions import Fraction
from math import ceil

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.odometer.host.bounds import interval_bounds_s, period_bounds_kmh, phase_bounds_deg
from railgate.odometer.spec import Config

CONFIG = Config()


def rounded(value: float | Fraction, places: str) -> Decimal:
    exact = Fraction(value)
    quotient = Decimal(exact.numerator) / Decimal(exact.denominator)
    return quotient.quantize(Decimal(places), rounding=ROUND_HALF_UP)


def as_stated(value: float | Fraction, stated: str) -> bool:
    return rounded(value, f"1e{Decimal(stated).as_tuple().exponent}") == Decimal(stated)


@pytest.mark.shows("ODO-3")
def test_one_period_at_200_kmh_is_what_section_2_2_states() -> None:
    low, high = period_bounds_kmh(200, CONFIG)
    assert as_stated(low, "199.932")
    assert as_stated(high, "200.068")


@pytest.mark.shows("ODO-4")
@pytest.mark.parametrize(
    ("khz", "low", "high"),
    [
        ("0.1", "89.997", "90.003"),
        ("1", "89.972", "90.028"),
        ("2", "89.944", "90.056"),
        ("4", "89.888", "90.113"),
        ("6", "89.831", "90.169"),
    ],
)
def test_phase_bounds_are_those_of_table_1(khz: str, low: str, high: str) -> None:
    bounds = phase_bounds_deg(1000 * Fraction(khz), CONFIG)
    assert all(map(as_stated, bounds, (low, high)))


@pytest.mark.shows("ODO-4")
@pytest.mark.parametrize(
    ("khz", "period", "delta"),
    [
        ("0.1", ("0.999994e-2", "1.00001e-2"), ("2.49994e-3", "2.50006e-3")),
        ("1", ("0.999938e-3", "1.00006e-3"), ("2.49938e-4", "2.50063e-4")),
        ("2", ("4.99938e-4", "5.00063e-4"), ("1.24938e-4", "1.25063e-4")),
        ("4", ("2.49938e-4", "2.50063e-4"), ("6.24375e-5", "6.25625e-5")),
        ("6", ("1.66604e-4", "1.66729e-4"), ("4.16042e-5", "4.17292e-5")),
    ],
)
def test_interval_bounds_are_those_of_table_1(
    khz: str, period: tuple[str, str], delta: tuple[str, str]
) -> None:
    """The T minimum at 1 kHz is the one that the table misprints."""
    true_s = 1 / (1000 * Fraction(khz))
    assert all(map(as_stated, interval_bounds_s(true_s, CONFIG), period))
    assert all(map(as_stated, interval_bounds_s(true_s / 4, CONFIG), delta))


@pytest.mark.shows("ODO-3", "ODO-4")
@given(st.integers(2_600_000, 3_200_000), st.integers(0, 999), st.integers(125, 375))
@settings(deadline=None)
def test_every_measured_period_and_phase_lies_inside(
    thousandths: int, offset: int, share: int
) -> None:
    ticks, first, part = Fraction(thousandths, 1000), Fraction(offset, 1000), Fraction(share, 1000)
    period = ceil(first + ticks) - ceil(first)
    delta = ceil(first + part * ticks) - ceil(first)
    low, high = period_bounds_kmh(CONFIG.period_ticks(float(ticks)), CONFIG)
    assert low < CONFIG.period_ticks(period) < high
    least, most = phase_bounds_deg(CONFIG.clock_hz / ticks, CONFIG, 360 * part)
    assert least < Fraction(360 * delta, period) < most
