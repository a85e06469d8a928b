"""Configurations from TOML files."""

from __future__ import annotations

from fractions import Fraction

import pytest

from railgate.fpga.export.configuration import read_configuration
from railgate.odometer.spec import Config as Odometer
from railgate.position_link.spec import Check, Edge
from railgate.position_link.spec import Config as Link
from railgate.vital_output.spec import Config as Vital


def read(tmp_path, kind, text: str):
    path = tmp_path / "config.toml"
    path.write_text(text, encoding="utf-8")
    return read_configuration(kind, path)


def test_what_is_left_out_is_as_by_default(tmp_path) -> None:
    for kind in (Odometer, Link, Vital):
        assert read(tmp_path, kind, "") == kind()


def test_every_kind_of_field_can_be_written(tmp_path) -> None:
    text = "sensors = 1\nwheel_diameter_m = 0.92\noverspeed_kmh = 90"
    assert read(tmp_path, Odometer, text) == Odometer(
        sensors=1, wheel_diameter_m=Fraction(92, 100), overspeed_kmh=Fraction(90)
    )
    text = """
        cycle_s = "1/100"
        bare = true
        sampling_edge = "rising"
        fault_word = 0xdead
        check = {width = 1, polynomial = 1}
    """
    assert read(tmp_path, Link, text) == Link(
        cycle_s=Fraction(1, 100),
        bare=True,
        sampling_edge=Edge.RISING,
        fault_word=0xDEAD,
        check=Check(width=1, polynomial=1),
    )
    text = "boards = [1, 2]\nerror_interval_s = 60"
    assert read(tmp_path, Vital, text) == Vital(boards=(1, 2), error_interval_s=Fraction(60))


@pytest.mark.parametrize(
    ("kind", "text", "says"),
    [
        (Odometer, "wheels = 1", 'no key "wheels" is known; there are: clock_hz, sensors'),
        (Odometer, "sensors = 0", "sensors must be between 1 and 16, not 0"),
        (Odometer, "sensors = true", "sensors must be a whole number, not True"),
        (Odometer, "sensors = 1.5", "sensors must be a whole number, not 1.5"),
        (Odometer, "overspeed_kmh = inf", "overspeed_kmh must be a number, .* not Infinity"),
        (Odometer, 'overspeed_kmh = "1/0"', "overspeed_kmh must be a number, .* not 1/0"),
        (Odometer, 'overspeed_kmh = "fast"', "overspeed_kmh must be a number, .* not fast"),
        (Link, "bare = 1", "bare must be true or false, not 1"),
        (Link, 'sampling_edge = "both"', "sampling_edge must be one of falling, rising, not both"),
        (Link, "sampling_edge = []", r"sampling_edge must be one of falling, rising, not \[\]"),
        (Link, "check = {width = 1}", "the key polynomial is missing"),
        (Link, "check = 3", "check must be a table or list, not 3"),
        (Vital, "boards = [1]", "boards must have 2 values, not 1"),
        (Vital, "boards = 1", "boards must be a table or list, not 1"),
        (Odometer, "sensors", "config.toml: "),
        (Odometer, "\x80", "config.toml: "),
    ],
)
def test_what_is_wrong_is_told_in_one_line(tmp_path, kind, text, says) -> None:
    with pytest.raises(ValueError, match=says) as caught:
        read(tmp_path, kind, text)
    assert "\n" not in str(caught.value)
    assert "config.toml: " in str(caught.value)


def test_no_file_is_told(tmp_path) -> None:
    with pytest.raises(ValueError, match=r"none.toml: No such file"):
        read_configuration(Odometer, tmp_path / "none.toml")
    (tmp_path / "binary").write_bytes(b"\xff\xfe")
    with pytest.raises(ValueError, match="must be text in UTF-8"):
        read_configuration(Odometer, tmp_path / "binary")
