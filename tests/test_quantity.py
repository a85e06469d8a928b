"""Quantities with units are read exactly."""

from fractions import Fraction

import pytest

from railgate.quantity import frequency_hz, length_m, span_s, time_s


@pytest.mark.parametrize(
    ("parse", "text", "value"),
    [
        (frequency_hz, "16MHz", Fraction(16_000_000)),
        (frequency_hz, "512 kHz", Fraction(512_000)),
        (frequency_hz, "1000000", Fraction(1_000_000)),
        (time_s, "20ms", Fraction(1, 50)),
        (time_s, "62.5ns", Fraction(1, 16_000_000)),
        (time_s, "-.5", Fraction(-1, 2)),
        (length_m, "650mm", Fraction(13, 20)),
        (length_m, "0.65", Fraction(13, 20)),
        (span_s, "0.5..600ms", (Fraction(1, 2), Fraction(3, 5))),
    ],
)
def test_units_scale_exactly(parse, text, value) -> None:
    assert parse(text) == value


@pytest.mark.parametrize(
    ("parse", "text"),
    [
        (frequency_hz, "16MB"),
        (frequency_hz, ""),
        (time_s, "20mm"),
        (time_s, "nan"),
        (length_m, "six"),
        (span_s, "1"),
        (span_s, "2..1"),
    ],
)
def test_what_is_no_quantity_is_refused(parse, text) -> None:
    with pytest.raises(ValueError, match=r"needed|must end"):
        parse(text)
