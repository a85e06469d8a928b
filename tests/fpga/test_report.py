"""The report: its rows, what it keeps, and when a goal is met."""

import json
import re
from dataclasses import replace

import pytest

from railgate.fpga import report as module
from railgate.fpga.parts import PARTS, REFERENCE, Area
from railgate.fpga.report import SEEDS, Row, report
from railgate.fpga.targets import TARGETS, Goal, chosen


def row(*fmax_mhz: float, median_mhz: float | None = None, **more) -> Row:
    goal = Goal(280, median_mhz, lut_ratio=1.3)
    return Row("odometer", REFERENCE, goal, fmax_mhz=fmax_mhz, **{"area": Area(1, 2), **more})


@pytest.mark.parametrize(
    ("of", "met"),
    [
        (row(280, 281, 282, 283, 284), True),
        (row(279.9, 300, 300, 300, 300), False),
        (row(280, 280, 300, 310, 310, median_mhz=300), True),
        (row(280, 280, 299.9, 310, 310, median_mhz=300), False),
        (row(290, 290), None),
        (row(290, 270), False),
        (row(), None),
        (row(failed="too big"), False),
        (row(*[500] * 5, peer=Area(1)), True),
        (row(*[500] * 5, peer=Area(1), area=Area(2)), False),
        (replace(row(500, 500, 500, 500, 500), goal=None), None),
    ],
)
def test_a_goal_is_met_by_all_seeds_only_and_missed_by_one(of, met) -> None:
    assert of.met is met


def test_the_rows_are_as_documented() -> None:
    told = row(281.26, 290, 300, 310, 320, median_mhz=300, digest="0123", peer=Area(3)).as_json()
    assert told == {
        "target": "odometer",
        "part": REFERENCE,
        "digest": "0123",
        "fmax_worst_mhz": 281.3,
        "fmax_median_mhz": 300,
        "lut": 1,
        "ff": 2,
        "ram": 0,
        "dsp": 0,
        "goal_mhz": 280,
        "goal_median_mhz": 300,
        "lut_ratio": 0.33,
        "goal_lut_ratio": 1.3,
        "met": True,
        "seeds": 5,
        "failed": "",
    }
    assert set(told) <= set(re.findall(r"`(\w+)`", module.__doc__))


def test_a_report_is_kept_as_it_comes_and_goes_on_where_it_was(tmp_path) -> None:
    kept = tmp_path / "fpga.json"
    steps = []

    def placed() -> None:
        steps.append(json.loads(kept.read_text("utf-8")))

    rows = report(chosen(["lfsr", "ssi"]), seeds=2, folder=tmp_path, placed=placed)
    assert [(told[-1]["target"], told[-1]["seeds"]) for told in steps] == [
        *(("lfsr", seed) for seed in (1, 2)),
        *(("ssi", seed) for seed in (1, 2)),
    ]
    assert steps[-1] == [each.as_json() for each in rows]
    again = report(chosen(["ssi", "lfsr"]), seeds=2, folder=tmp_path, limit_s=1e-3)
    assert again == rows


def test_a_target_that_cannot_be_placed_has_its_row_and_the_others_theirs(tmp_path, monkeypatch):
    small = replace(PARTS[REFERENCE], has=Area(lut=90, ff=1000))
    monkeypatch.setitem(PARTS, REFERENCE, small)
    big, little = report(chosen(["crc32", "ssi"]), seeds=1, folder=tmp_path)[::-1]
    assert big.failed.startswith("crc32 must take at most 75% of the 90 LUT")
    assert big.worst_mhz is None
    assert big.area
    assert big.area.lut > 90
    assert little.worst_mhz
    assert not little.failed


def test_each_part_has_its_rows_and_goals_are_of_the_reference_alone(tmp_path) -> None:
    parts = (REFERENCE, "iCE40-HX8K")
    rows = report({"lfsr": replace(TARGETS["lfsr"], goal=Goal(1))}, parts, seeds=1, folder=tmp_path)
    assert [(row.part, row.goal) for row in rows] == [
        (REFERENCE, Goal(1)),
        ("iCE40-HX8K", None),
    ]
    assert rows[0].fmax_mhz != rows[1].fmax_mhz


def test_all_functions_are_targets_and_have_their_goals() -> None:
    goals = {name: target.goal for name, target in TARGETS.items() if target.kind == "function"}
    assert goals == {
        "position_link": Goal(280),
        "odometer": Goal(280, 300, lut_ratio=1.3),
        "vital_output": Goal(150),
    }
    assert SEEDS >= 5


def test_a_target_that_is_not_there_is_told() -> None:
    with pytest.raises(ValueError, match=r'one of lfsr, .*, vital_output, not "wheel"'):
        chosen(["lfsr", "wheel"])
