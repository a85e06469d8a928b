"""Each requirement is traced to what shows it, and its status follows from that."""

import pytest

from railgate.evidence.claims import claims
from railgate.evidence.digests import TESTS, digests
from railgate.evidence.marks import marked
from railgate.evidence.matrix import KINDS, Evidence, Matrix, Row, Status
from railgate.evidence.requirements import REQUIREMENTS, Requirement
from railgate.evidence.results import Case, Ran, keep_proof, keep_tests
from railgate.evidence.tracing import trace
from railgate.proving.result import Rejection, Result

pytestmark = pytest.mark.shows("SYS-4")

NAME = "tests/test_a.py::test_one"
PASSED, FAILED, SKIPPED = (Case(outcome, 0.1, 1e9) for outcome in ("passed", "failed", "skipped"))
ON = {name: d for name, d in digests().items() if name != "proven"}


@pytest.fixture
def tests(tmp_path):
    """A checkout's, with one test that shows ODO-15."""
    folder = tmp_path / "tests"
    folder.mkdir()
    (folder / "test_a.py").write_text('@pytest.mark.shows("ODO-15")\ndef test_one(): ...\n')
    return folder


def of(matrix: Matrix, name: str) -> Row:
    return next(row for row in matrix.rows if row.requirement.name == name)


@pytest.mark.parametrize(
    ("on", "cases", "result", "told", "status"),
    [
        (ON, {"": PASSED}, "passed", "passed", Status.GREEN),
        (ON, {"a": PASSED, "b": PASSED}, "passed", "2 of 2 cases", Status.GREEN),
        (ON, {"a": PASSED, "b": FAILED}, "failed", "1 of 2 cases", Status.RED),
        (ON, {"a": PASSED, "b": SKIPPED}, "incomplete", "1 of 2 cases", Status.AMBER),
        (ON, {"": SKIPPED}, "incomplete", "skipped", Status.AMBER),
        (ON | {"railgate": "older"}, {"": PASSED}, "stale", "passed", Status.AMBER),
        (ON | {"railgate": "older"}, {"": FAILED}, "failed", "failed", Status.RED),
    ],
)
def test_a_tests_last_run_makes_its_result(tmp_path, tests, on, cases, result, told, status):
    keep_tests({NAME: Ran(on, ("ODO-15",), False, len(cases), cases)}, tmp_path)
    row = of(trace(tmp_path, tests), "ODO-15")
    assert row.of("test") == [Evidence("test", NAME, "one", result, told, 1e9)]
    assert row.status is status
    assert row.oldest == 1e9


@pytest.mark.parametrize(("cases", "told"), [(3, "1 of 3 cases"), (0, "1 of some cases")])
def test_a_case_that_was_not_run_is_missing(tmp_path, tests, cases, told) -> None:
    keep_tests({NAME: Ran(ON, ("ODO-15",), False, cases, {"a": PASSED})}, tmp_path)
    (found,) = of(trace(tmp_path, tests), "ODO-15").of("test")
    assert (found.result, found.told) == ("incomplete", told)


def test_a_test_that_was_never_run_is_there_and_one_that_is_gone_is_not(tmp_path, tests) -> None:
    gone = "tests/test_a.py::test_gone"
    keep_tests({gone: Ran(ON, ("ODO-15",), False, 1, {"": PASSED})}, tmp_path)
    row = of(trace(tmp_path, tests), "ODO-15")
    assert row.of("test") == [Evidence("test", NAME, "one", "not run")]
    assert (row.status, row.oldest) == (Status.AMBER, None)


def test_without_a_checkout_the_tests_that_were_run_count(tmp_path) -> None:
    keep_tests({NAME: Ran(ON, ("ODO-15",), True, 1, {"": PASSED})}, tmp_path)
    row = of(trace(tmp_path, tmp_path / "none"), "ODO-15")
    assert row.of("sweep") == [Evidence("sweep", NAME, "one", "passed", "passed", 1e9)]


@pytest.mark.parametrize(
    ("status", "rejected", "on", "result"),
    [
        ("proven", True, digests(), "passed"),
        ("bounded", True, digests(), "passed"),
        ("proven", None, digests(), "incomplete"),
        ("failed", False, digests(), "failed"),
        ("proven", True, {"proven": "older"}, "stale"),
    ],
)
def test_a_proof_counts_with_all_its_mutants_rejected(tmp_path, status, rejected, on, result):
    claim = claims()[0]
    mutants = tuple(Rejection(mutant.name, rejected) for mutant in claim.mutants)
    proof = Result(claim=claim, status=status, reason="", seconds=1, mutants=mutants)
    keep_proof(proof, on, tmp_path)
    for requirement in claim.requirements:
        row = of(trace(tmp_path, tmp_path), requirement)
        (found,) = (each for each in row.evidence if each.name == claim.name)
        assert (found.kind, found.says, found.result) == ("proof", claim.claim, result)
        assert str(claim.method) in found.told
        tried = {True: f"{len(mutants)}", None: "none", False: "0"}[rejected]
        assert f"{tried} of {len(mutants)} mutants rejected" in found.told


def test_an_unknown_requirement_is_refused(tmp_path, tests) -> None:
    (tests / "test_a.py").write_text('@pytest.mark.shows("ODO-99")\ndef test_one(): ...\n')
    with pytest.raises(ValueError, match=rf"^{NAME} speaks for ODO-99, which is no requirement$"):
        trace(tmp_path, tests)


@pytest.mark.parametrize(
    ("planned", "results", "status"),
    [
        (False, [], Status.RED),
        (False, ["cited"], Status.RED),
        (False, ["cited", "passed"], Status.GREEN),
        (False, ["passed", "not run"], Status.AMBER),
        (False, ["not run", "failed", "passed"], Status.RED),
        (True, [], Status.GREY),
        (True, ["failed"], Status.GREY),
    ],
)
def test_gateware_alone_shows_nothing_and_the_worst_result_rules(planned, results, status):
    evidence = tuple(Evidence("test", "t", "", result) for result in results)
    assert Row(Requirement("ODO-1", "", planned), evidence).status is status


def test_gateware_is_found_by_what_it_cites(tmp_path) -> None:
    matrix = trace(tmp_path, tmp_path)

    def files(name: str) -> set[str]:
        return {each.name for each in of(matrix, name).of("gateware")}

    assert "primitives/inputs.py" in files("ODO-9")
    for number in range(8, 13):  # "DRV-8 … DRV-12"
        assert "vital_output/gateware/output.py" in files(f"DRV-{number}")
    assert not any("plant" in name for row in matrix.rows for name in files(row.requirement.name))


def test_every_test_and_claim_of_the_checkout_is_in_the_matrix(tmp_path) -> None:
    matrix = trace(tmp_path)
    there = {
        (each.kind, each.name, row.requirement.name) for row in matrix.rows for each in row.evidence
    }
    for name, marks in marked(TESTS).items():
        kind = "sweep" if marks.sweep else "test"
        assert {(kind, name, requirement) for requirement in marks.shows} <= there
    for claim in claims():
        assert {("proof", claim.name, requirement) for requirement in claim.requirements} <= there
    assert {kind for kind, _, _ in there} == set(KINDS)


def test_requirements_have_names_of_their_own_and_the_network_is_planned() -> None:
    groups = {"ODO": 16, "LNK": 8, "DRV": 18, "NET": 5, "SYS": 6}
    names = [f"{group}-{n + 1}" for group, many in groups.items() for n in range(many)]
    assert [each.name for each in REQUIREMENTS] == names
    assert {each.name for each in REQUIREMENTS if each.planned} == {f"NET-{n}" for n in range(1, 6)}
    assert all(each.sentence.endswith(".") for each in REQUIREMENTS)
