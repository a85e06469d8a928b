"""Each session of pytest leaves its results for `railgate evidence`."""

import subprocess
import sys
from pathlib import Path

import pytest

from railgate.evidence.results import RESULTS, Ran, read_tests

pytestmark = pytest.mark.shows("SYS-4")

CONFTEST = Path(__file__).parent.parent / "conftest.py"
TEXT = """
import os

import pytest

pytestmark = pytest.mark.shows("ODO-1")

@pytest.mark.parametrize("n", [1, 2, 3])
def test_cases(n):
    assert n != {wrong}

@pytest.mark.shows("ODO-2", kind="sweep")
def test_sweep(): ...

@pytest.fixture
def broken():
    yield
    assert not {wrong}

def test_torn_down(broken): ...

def test_skipped():
    pytest.skip("not here")

{more}
"""
PLACE = "tests/test_a.py::"


@pytest.fixture
def session(tmp_path):
    """Runs pytest in a checkout of its own and gives what was kept."""

    def run(*arguments: str, wrong: int = 0, more: str = "") -> dict[str, Ran]:
        tests = tmp_path / "tests"
        tests.mkdir(exist_ok=True)
        (tests / "conftest.py").write_text(CONFTEST.read_text(encoding="utf-8"), encoding="utf-8")
        (tests / "test_a.py").write_text(TEXT.format(wrong=wrong, more=more))
        how = ("-q", "--strict-markers", "--import-mode=importlib", f"--rootdir={tmp_path}")
        command = [sys.executable, "-m", "pytest", *how, *(arguments or ("tests",))]
        ended = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
        assert ended.returncode in (0, 1), ended.stdout + ended.stderr
        return read_tests(tmp_path / RESULTS)

    return run


def outcomes(ran: Ran) -> dict[str, str]:
    return {name: case.outcome for name, case in ran.cases.items()}


@pytest.mark.parametrize("workers", [(), ("-n", "1")])
def test_outcomes_are_kept_with_what_they_show_and_were_run_on(session, workers) -> None:
    kept = session("tests", *workers, wrong=2)
    assert {name.removeprefix(PLACE): outcomes(ran) for name, ran in kept.items()} == {
        "test_cases": {"1": "passed", "2": "failed", "3": "passed"},
        "test_sweep": {"": "passed"},
        "test_torn_down": {"": "failed"},
        "test_skipped": {"": "skipped"},
    }
    assert {(ran.shows, ran.sweep, ran.of) for ran in kept.values()} == {
        (("ODO-1",), False, 3),
        (("ODO-2", "ODO-1"), True, 1),
        (("ODO-1",), False, 1),
    }
    for ran in kept.values():
        assert ran.on.keys() == {"railgate", "tests"}
        assert all(case.at > 1e9 and 0 <= case.seconds < 60 for case in ran.cases.values())


def test_the_latest_outcome_of_a_case_counts_and_the_others_stay(session) -> None:
    session(wrong=2)
    kept = session("tests/test_a.py::test_cases[2]", wrong=0)
    assert outcomes(kept[PLACE + "test_cases"]) == {"1": "passed", "2": "passed", "3": "passed"}
    assert kept[PLACE + "test_cases"].of == 3
    assert outcomes(kept[PLACE + "test_torn_down"]) == {"": "failed"}


def test_of_a_case_that_is_named_alone_it_is_not_known_how_many_others_there_are(session) -> None:
    kept = session("tests/test_a.py::test_cases[2]")
    assert outcomes(kept[PLACE + "test_cases"]) == {"2": "passed"}
    assert kept[PLACE + "test_cases"].of == 0


def test_cases_left_out_are_known_to_be_missing(session) -> None:
    kept = session("tests", "-k", "3")
    assert outcomes(kept[PLACE + "test_cases"]) == {"3": "passed"}
    assert kept[PLACE + "test_cases"].of == 3


def test_a_test_that_breaks_its_process_down_has_failed(session) -> None:
    kept = session("tests", "-n", "1", more="def test_exits(): os._exit(3)")
    assert outcomes(kept[PLACE + "test_exits"]) == {"": "failed"}


def test_results_that_cannot_be_kept_do_not_fail_the_tests(session, tmp_path) -> None:
    (tmp_path / "build").write_text("")
    assert session("tests", "-k", "sweep") == {}
