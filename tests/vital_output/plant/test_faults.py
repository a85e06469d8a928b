"""Faults are read from text."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from railgate.vital_output.plant.faults import FAULTS, Fault, fault


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("welded@0.1s", Fault("welded", Fraction(1, 10))),
        ("welded:3@0.1s", Fault("welded", Fraction(1, 10), None, 3)),
        (" stopped-1@60ms..140ms ", Fault("stopped-1", Fraction(3, 50), Fraction(7, 50))),
        ("time-step-2:-40@5us", Fault("time-step-2", Fraction(5, 10**6), None, -40)),
    ],
)
def test_a_fault_is_read_from_text(text: str, expected: Fault) -> None:
    assert fault(text) == expected


@given(
    st.text(alphabet="aelsthorg-:@.0123456789ms \n", max_size=20)
    | st.builds("{}:{}@{}".format, st.sampled_from(list(FAULTS)), st.text(), st.text())
)
def test_any_text_is_a_fault_or_refused_in_one_line(text: str) -> None:
    try:
        told = f"{fault(text)}"
    except ValueError as error:
        told = str(error)
    assert "\n" not in told


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("welded", "a fault must be KIND@TIME, KIND@T0..T1 or, with a whole number, KIND:VALUE@"),
        ("welded:x@1s", "a fault must be KIND@TIME, KIND@T0..T1 or"),
        ("weld@1s", 'a fault must be one of disagree, skew, .*, test-fails, not "weld"'),
        ("welded@x", "a number with s, ms, us, .* is needed, not 'x'"),
        ("welded@2s..1s", "a span must end after it begins, not '2s..1s'"),
        ("welded@-1s", "welded must begin at 0 s at the earliest, not -1 s"),
        ("repetition-1:2@1s", "repetition-1 takes no value, not 2"),
    ],
)
def test_what_is_no_fault_is_refused(text: str, error: str) -> None:
    with pytest.raises(ValueError, match=error):
        fault(text)


def test_a_fault_must_end_after_it_begins() -> None:
    with pytest.raises(ValueError, match="welded must end after it begins at 1 s, not at 1 s"):
        Fault("welded", Fraction(1), Fraction(1))
    with pytest.raises(ValueError, match='not "rust"'):
        Fault("rust", Fraction(1))
