"""What is kept of tests and proofs, and what a later run makes of it."""

from dataclasses import replace
from pathlib import Path

import pytest

from proving.counting import NeverAbove, claim
from railgate.evidence.results import (
    Case,
    Ran,
    keep_proof,
    keep_tests,
    read_proofs,
    read_tests,
)
from railgate.proving.result import Rejection, Result

pytestmark = pytest.mark.shows("SYS-4")

ON, LATER = {"railgate": "1", "tests": "1"}, {"railgate": "2", "tests": "1"}
PASSED, FAILED = Case("passed", 0.5, 100.0), Case("failed", 0.5, 200.0)
NAME = "tests/test_a.py::test_one"


def ran(on, of=0, **cases) -> Ran:
    return Ran(on, shows=("ODO-1",), sweep=True, of=of, cases=cases)


def test_what_is_kept_comes_back(tmp_path) -> None:
    assert read_tests(tmp_path) == {}
    kept = {NAME: ran(ON, 2, a=PASSED, b=FAILED), "tests/test_b.py::test": ran(ON)}
    keep_tests(kept, tmp_path / "new")
    assert read_tests(tmp_path / "new") == kept


def test_runs_on_the_same_sources_add_up_and_the_latest_counts(tmp_path) -> None:
    keep_tests({NAME: ran(ON, 3, a=FAILED, b=PASSED)}, tmp_path)
    keep_tests({NAME: ran(ON, 0, a=PASSED)}, tmp_path)
    assert read_tests(tmp_path) == {NAME: ran(ON, 3, a=PASSED, b=PASSED)}


def test_a_run_on_other_sources_voids_those_before(tmp_path) -> None:
    keep_tests({NAME: ran(ON, 3, a=PASSED, gone=PASSED)}, tmp_path)
    keep_tests({NAME: ran(LATER, 1, a=PASSED)}, tmp_path)
    assert read_tests(tmp_path) == {NAME: ran(LATER, 1, a=PASSED)}


def test_other_tests_stay_as_they_were(tmp_path) -> None:
    keep_tests({NAME: ran(ON, 1, a=PASSED)}, tmp_path)
    keep_tests({"tests/test_b.py::test": ran(LATER, 1, a=PASSED)}, tmp_path)
    assert read_tests(tmp_path)[NAME] == ran(ON, 1, a=PASSED)


MUTANTS = (Rejection("one", True), Rejection("two", False))


def result(status: str, *mutants: Rejection) -> Result:
    counted = replace(claim(NeverAbove), name="counter.right")
    tried = mutants or (Rejection("one"), Rejection("two"))
    return Result(claim=counted, status=status, reason="", seconds=1.234, mutants=tried)


def test_of_a_proof_status_time_and_rejected_mutants_are_kept(tmp_path) -> None:
    keep_proof(result("failed", *MUTANTS), {"proven": "1", "railgate": "2"}, tmp_path)
    proof = read_proofs(tmp_path)["counter.right"]
    assert (proof.on, proof.status, proof.rejected) == ({"proven": "1"}, "failed", 1)
    assert proof.seconds == 1.23
    assert proof.at > 1e9


@pytest.mark.parametrize(
    ("status", "on", "rejected"),
    [("proven", "1", 1), ("proven", "2", None), ("failed", "1", None)],
)
def test_mutants_tried_before_count_on_while_the_sources_are_the_same(
    tmp_path, status, on, rejected
) -> None:
    keep_proof(result("proven", *MUTANTS), {"proven": "1"}, tmp_path)
    keep_proof(result(status), {"proven": on}, tmp_path)
    assert read_proofs(tmp_path)["counter.right"].rejected == rejected


@pytest.mark.parametrize("text", ["", "[1]", '{"a": 1}', '{"a": {"on": {}}}', '{"a": {"x": 1}}'])
@pytest.mark.parametrize(("name", "read"), [("tests", read_tests), ("proofs", read_proofs)])
def test_what_is_damaged_is_refused_in_one_line(tmp_path, text, name, read) -> None:
    (tmp_path / f"{name}.json").write_text(text)
    with pytest.raises(ValueError, match=rf"{name}\.json must hold results .*; remove it$"):
        read(tmp_path)


def test_a_folder_that_cannot_be_written_is_told() -> None:
    with pytest.raises(ValueError, match="/dev/null/x cannot be written"):
        keep_tests({NAME: ran(ON)}, Path("/dev/null/x"))
