"""`evidence`, and what `prove` leaves for it."""

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest

from proving.counting import NeverAbove, claim
from railgate.evidence.claims import claims
from railgate.evidence.digests import TESTS, digests
from railgate.evidence.marks import marked
from railgate.evidence.matrix import Evidence, Matrix, Row
from railgate.evidence.requirements import REQUIREMENTS
from railgate.evidence.results import Case, Ran, keep_proof, keep_tests, read_proofs
from railgate.proving.result import Rejection, Result

pytestmark = pytest.mark.shows("SYS-4")

DOCS = (Path(__file__).parents[2] / "docs" / "commands.md").read_text(encoding="utf-8")


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)


def all_passed() -> None:
    """Results of every test and claim, on the sources as they are."""
    on = {name: digest for name, digest in digests().items() if name != "proven"}
    case = {"": Case("passed", 0.1, 1e9)}
    keep_tests({n: Ran(on, m.shows, m.sweep, 1, case) for n, m in marked(TESTS).items()})
    for each in claims():
        mutants = tuple(Rejection(mutant.name, True) for mutant in each.mutants)
        proof = Result(claim=each, status="proven", reason="", seconds=1, mutants=mutants)
        keep_proof(proof, digests())


def test_without_any_result_nothing_is_green(railgate, tmp_path) -> None:
    code, out, err = railgate("evidence", "--strict")
    assert (code, err) == (1, "")
    assert re.search(r"ODO-6 .* amber .* 0 of", out)
    assert "\n0 green, " in out
    assert "5 grey\n" in out
    for name in ("matrix.html", "matrix.json"):
        assert f"wrote build/evidence/{name}\n" in out
        assert (tmp_path / "build/evidence" / name).exists()


def test_what_passed_is_green_and_the_exit_code_tells_whether_one_is_red(railgate) -> None:
    all_passed()
    code, out, _ = railgate("evidence", "--json", "--out", "elsewhere")
    told = json.loads(out)
    assert list(told) == [requirement.name for requirement in REQUIREMENTS]
    for name, row in told.items():
        shown = [each for each in row["evidence"] if each["kind"] != "gateware"]
        planned = name.startswith("NET")
        assert row["status"] == ("grey" if planned else "green" if shown else "red")
    assert code == int("red" in {row["status"] for row in told.values()})
    assert Path("elsewhere/matrix.html").exists()


@pytest.mark.parametrize(
    ("result", "codes"), [("passed", (0, 0)), ("not run", (0, 1)), ("failed", (1, 1))]
)
def test_amber_fails_if_strict_and_red_always(railgate, monkeypatch, result, codes) -> None:
    shown = Evidence("test", "test_a", "it holds", result)
    matrix = Matrix((Row(REQUIREMENTS[0], (shown,)), Row(REQUIREMENTS[-7], ())), 1e9)
    monkeypatch.setattr("railgate.evidence.tracing.trace", lambda: matrix)
    assert (railgate("evidence")[0], railgate("evidence", "--strict")[0]) == codes


def test_a_test_that_failed_is_red_and_named(railgate) -> None:
    all_passed()
    name, marks = next(iter(marked(TESTS).items()))
    now = digests()
    on = {each: now[each] for each in ("railgate", "tests")}
    keep_tests({name: Ran(on, marks.shows, marks.sweep, 1, {"": Case("failed", 0.1, 1e9)})})
    code, out, _ = railgate("evidence")
    assert code == 1
    assert f"{marks.shows[0]}: {name} failed" in out


def test_damaged_results_are_one_clear_line_and_exit_code_2(railgate) -> None:
    all_passed()
    Path("build/evidence/proofs.json").write_text("{")
    code, out, err = railgate("evidence")
    assert (code, out) == (2, "")
    assert err == (
        "railgate: build/evidence/proofs.json must hold results as railgate keeps them; remove it\n"
    )


def test_prove_leaves_its_results(railgate, monkeypatch) -> None:
    right, wrong = claim(NeverAbove), claim(lambda: NeverAbove(3))
    there = (replace(right, name="counter.right"), replace(wrong, name="counter.wrong"))
    monkeypatch.setattr("railgate.evidence.claims.claims", lambda: there)
    railgate("prove", "counter.right")
    railgate("prove", "counter.wrong")
    kept = read_proofs()
    statuses = {name: (proof.status, proof.rejected) for name, proof in kept.items()}
    assert statuses == {"counter.right": ("proven", None), "counter.wrong": ("failed", None)}
    assert kept["counter.right"].on.keys() == {"proven"}


def test_the_json_object_is_as_documented(railgate) -> None:
    page = DOCS.partition("## railgate evidence\n")[2].partition("\n## ")[0]
    told = json.loads(railgate("evidence", "--json")[1])
    names = {name for row in told.values() for each in (row, *row["evidence"]) for name in each}
    words = {row["status"] for row in told.values()} | {"green", "failed", "stale", "incomplete"}
    assert names | words <= set(re.findall(r"`(\w+)`", page))
