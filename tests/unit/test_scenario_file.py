"""Scenarios as files: every built-in one, and every error with its line."""

from __future__ import annotations

import string
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from railgate.unit.scenario_file import builtin, builtins, parse_scenario, read_scenario

TEXT = """\
name = "two platforms"
seed = 3

[train]
speed_kmh = 50

[[stop]]
at_m = 100
side = "left"

[[stop]]
at_m = 400
dwell_s = 12.5

[[fault]]
part = "wheel"
kind = "slip"
at_m = 250
lasts_s = 2
"""


def test_all_that_a_file_says_is_in_the_scenario() -> None:
    scenario = parse_scenario(TEXT, "here.toml")
    assert (scenario.name, scenario.seed, scenario.route.speed_kmh) == ("two platforms", 3, 50)
    assert [stop.at_m for stop in scenario.route.stops] == [100, 400]
    assert scenario.route.stops[1].dwell_s == 12.5
    (fault,) = scenario.faults
    assert fault.end_s == fault.start_s + 2
    place = scenario.profile.position_m([float(fault.start_s)])[0]
    assert 100 + place == pytest.approx(250, abs=1e-3)


@pytest.mark.parametrize("name", builtins())
def test_every_built_in_scenario_is_one(name: str) -> None:
    scenario = builtin(name)
    assert scenario.name
    assert 30 < scenario.seconds < 600


ERRORS = (
    ("seed = 3", "seed = 3.5", 2, "seed: a whole number is needed, not 3.5"),
    ("seed = 3", "sede = 3", 2, 'no key "sede" is known'),
    ('name = "two platforms"', "", 1, "the key name is missing"),
    ("speed_kmh = 50", 'speed_kmh = "fast"', 5, "speed_kmh: a number is needed, not fast"),
    ("speed_kmh = 50", "speed_kmh = 700", 5, "speed_kmh must be between 1 and 600, not 700"),
    ("at_m = 400", "at_m = -1", 12, "at_m must be between 0 and 1000000, not -1"),
    ("at_m = 400", "at_m = 50", 11, "stops must be in order of place, not 50 m after 100 m"),
    ('side = "left"', 'side = "up"', 9, "side: a side must be left or right, not up"),
    ("dwell_s = 12.5", "dwell_s = nan", 13, "dwell_s: a number is needed, not NaN"),
    ('kind = "slip"', 'kind = "skid"', 17, "kind must be one of locked, slide, slip"),
    ('part = "wheel"', 'part = "door"', 16, 'part must be one of wheel, link, vital, not "door"'),
    ("at_m = 250", "at_m = 250\nat_s = 3", 15, "a fault must have at_s or at_m"),
    ("at_m = 250", "at_m = 900", 18, "at_m must be passed by the train, not 900 m"),
    ("lasts_s = 2", "lasts_s = 0", 19, "lasts_s must be above 0, not 0"),
    ("lasts_s = 2", "axle = 3", 19, "axle must be between 1 and 2, not 3"),
    ("[train]", "[[train]]", 4, "train must be a table"),
)


@pytest.mark.parametrize(("right", "wrong", "line", "told"), ERRORS)
def test_an_error_tells_its_line(right: str, wrong: str, line: int, told: str) -> None:
    assert right in TEXT
    with pytest.raises(ValueError, match=r"here\.toml") as caught:
        parse_scenario(TEXT.replace(right, wrong), "here.toml")
    message = str(caught.value)
    assert message.startswith(f"here.toml:{line}: ")
    assert told in message


def test_what_is_no_toml_tells_its_line_too() -> None:
    with pytest.raises(ValueError, match=r"here\.toml: .*line 2"):
        parse_scenario("name = 'x'\nseed =\n", "here.toml")


@given(
    st.lists(st.sampled_from(TEXT.splitlines()), max_size=30).map("\n".join)
    | st.text(string.printable, max_size=200)
)
def test_whatever_a_file_holds_it_is_a_scenario_or_one_line(text: str) -> None:
    told = ""
    try:
        parse_scenario(text, "x")
    except ValueError as error:
        told = str(error)
    assert "\n" not in told


def test_a_file_that_is_not_there_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="No such file"):
        read_scenario(tmp_path / "none.toml")
    with pytest.raises(ValueError, match=r'a scenario must be a file or one of .*, not "none"'):
        builtin("none")


def test_decimals_are_exact() -> None:
    text = TEXT.replace("seed = 3", "seed = 3\nppm_1 = 0.0625\nskew_s = 0.001")
    scenario = parse_scenario(text, "x")
    assert (scenario.ppm_1, scenario.skew_s) == (Fraction(1, 16), Fraction(1, 1000))
