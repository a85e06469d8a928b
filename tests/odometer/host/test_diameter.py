"""A wheel's diameter is kept whole, or it is an error; it is measured between two known points."""

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from railgate.odometer.host import WheelRecord, read_wheel, write_wheel

pytestmark = pytest.mark.shows("ODO-16")

LIMITS = (0.61, 0.67)
RECORD = WheelRecord(axle="1", diameter_m=0.6497, least_m=0.6495, greatest_m=0.65, day="2026-01-31")


@given(st.floats(0.61, 0.67), st.floats(0, 0.01), st.floats(0, 0.01), st.dates())
def test_what_is_written_is_read(tmp_path_factory, diameter, below, above, day) -> None:
    path = tmp_path_factory.mktemp("wheel") / "1.json"
    record = WheelRecord(
        axle="1",
        diameter_m=diameter,
        least_m=diameter - below,
        greatest_m=diameter + above,
        day=day.isoformat(),
    )
    write_wheel(path, record)
    assert read_wheel(path, "1", (0.5, 0.7)) == record


def test_any_damage_of_a_record_is_an_error(tmp_path: Path) -> None:
    """Every byte of the file, changed in one bit."""
    path = tmp_path / "1.json"
    write_wheel(path, RECORD)
    whole = path.read_bytes()
    for at in range(len(whole)):
        for bit in (0, 3, 6):
            path.write_bytes(whole[:at] + bytes([whole[at] ^ 1 << bit]) + whole[at + 1 :])
            try:
                assert read_wheel(path, "1", LIMITS) == RECORD  # a blank that became another
            except ValueError:
                continue
            assert whole[at : at + 1] in b" \n"
    for end in range(len(whole) - 1):
        path.write_bytes(whole[:end])
        with pytest.raises(ValueError, match=str(path)):
            read_wheel(path, "1", LIMITS)


def test_a_missing_record_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="cannot be read as a wheel's record"):
        read_wheel(tmp_path / "1.json", "1", LIMITS)


def test_another_axles_record_and_one_beyond_the_limits_are_errors(tmp_path: Path) -> None:
    path = tmp_path / "1.json"
    write_wheel(path, RECORD)
    with pytest.raises(ValueError, match="must be of axle 2, not 1"):
        read_wheel(path, "2", LIMITS)
    for limits in ((0.6496, 0.67), (0.61, 0.6499)):
        with pytest.raises(ValueError, match="a diameter must lie within"):
            read_wheel(path, "1", limits)


def test_a_file_of_other_fields_is_an_error(tmp_path: Path) -> None:
    path = tmp_path / "1.json"
    write_wheel(path, RECORD)
    content = json.loads(path.read_text())
    for other in ([], {**content, "tread": 1}, {k: v for k, v in content.items() if k != "day"}):
        path.write_text(json.dumps(other))
        with pytest.raises(ValueError, match="must hold the fields axle, checksum, day"):
            read_wheel(path, "1", LIMITS)


@pytest.mark.parametrize(
    ("field", "value", "words"),
    [
        ("diameter_m", 0.66, "diameter_m must be between 0.6495 and 0.65, not 0.66"),
        ("least_m", 0.66, "greatest_m must be between 0.66 and 10, not 0.65"),
        ("least_m", 0.0, "least_m must be between 0.01 and 10, not 0.0"),
        ("least_m", float("nan"), "least_m must be a number"),
        ("diameter_m", 1, "diameter_m must be a number with a decimal point, not 1"),
        ("day", "31.1.2026", "day must be a date YYYY-MM-DD, not '31.1.2026'"),
    ],
)
def test_a_record_that_cannot_be_is_refused(field: str, value: object, words: str) -> None:
    with pytest.raises(ValueError, match=words.replace(".", r"\.")):
        WheelRecord(**{**vars(RECORD), field: value})
