"""What is proven, what fails and why, and what never counts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from proving.counting import (
    INPUTS,
    Clocked,
    Forgotten,
    Impossible,
    NeverAbove,
    NeverGoing,
    Other,
    Signed,
    Unclocked,
    claim,
)
from railgate.odometer.proofs import inputs
from railgate.proving import Bounded, Claim, Induction, Mutant, Run, Search
from railgate.proving.counterexample import replay
from railgate.proving.prover import prove
from railgate.proving.result import Result
from railgate.proving.table import record
from railgate.proving.tools import Tools
from railgate.waves import read

SOLVERS = pytest.mark.parametrize("solver", ["yices", "z3"])


def judged(one: Claim, solver: str = "yices", **given: Any) -> Result:
    return prove([one], Tools(solver), **given)[0]


@SOLVERS
def test_what_holds_for_all_time_is_proven(solver: str) -> None:
    result = judged(claim(NeverAbove), solver)
    assert (result.status, result.reason, result.counterexample) == ("proven", "", None)
    assert [mutant.rejected for mutant in result.mutants] == [None, None]


WRONG = claim(lambda: NeverAbove(3))


@SOLVERS
def test_a_wrong_claim_fails_with_a_counterexample_that_runs_again(solver: str, tmp_path) -> None:
    result = judged(WRONG, solver)
    assert (result.status, result.reason) == ("failed", "holds is 0 in tick 4")
    (path,) = record(result, tmp_path)
    assert str(replay(WRONG, path)) == "holds is 0 in tick 4"
    assert replay(claim(NeverAbove), path) is None
    count = read(path, ["counter.count"])["counter.count"]
    assert count.values.tolist() == [0, 1, 2, 3, 4]
    assert record(replace(result, counterexample=None), tmp_path) == []
    assert not path.exists(), "a record replaces what was there"


def test_a_counterexample_tells_the_values_of_every_input() -> None:
    found = judged(claim(Signed)).counterexample
    assert found is not None
    assert {name: int(wave.values[0]) for name, wave in found.signals.items()} == {
        "pair.value": -3,
        "pair.sure": 1,
        "go": 1,
        "rst": 0,
    }


def test_a_bounded_claim_is_no_more_and_tells_why() -> None:
    result = judged(claim(lambda: NeverAbove(30), method=Bounded(9, "It is a test.")))
    assert (result.status, result.reason) == ("bounded", "It is a test.")
    assert result.as_json()["bound"] == 9


def test_an_open_induction_is_no_proof_and_no_counterexample(tmp_path) -> None:
    result = judged(claim(lambda: NeverAbove(30)))
    assert result.status == "failed"
    assert result.reason.startswith("the induction does not close at k = 1")
    assert result.counterexample is None
    (path,) = record(result, tmp_path)
    assert path.name == "step.vcd"
    assert "$enddefinitions" in path.read_text()


def test_a_lemma_closes_an_induction() -> None:
    assert judged(claim(lambda: NeverAbove(30, 5))).status == "proven"


def test_a_wrong_lemma_fails_the_claim_and_is_named() -> None:
    result = judged(claim(lambda: NeverAbove(30, 4)))
    assert (result.status, result.reason) == ("failed", "lemma.below is 0 in tick 5")


@pytest.mark.parametrize(
    ("monitor", "given", "says"),
    [
        (Unclocked, {}, "depends on no clocked register"),
        (Forgotten, {}, "1 registers are not clocked by clk"),
        (Other, {}, "1 registers are not clocked by clk"),
        (NeverAbove, {"cover": Search(5)}, "its cover is not reached"),
        (NeverGoing, {}, "its cover is not reached"),
        (NeverAbove, {"cover": Run(3)}, "its cover is not reached"),
        (NeverGoing, {"cover": Run(300)}, "its cover is not reached"),
        (Impossible, {}, "no stimulus keeps to what is assumed"),
    ],
)
def test_what_shows_nothing_fails(monitor: Callable[[], Any], given: Any, says: str) -> None:
    result = judged(claim(monitor, **given))
    assert result.status == "failed"
    assert result.reason.startswith(says)


@SOLVERS
def test_a_clock_of_its_own_has_its_edges_where_the_monitor_has_them(solver: str) -> None:
    assert judged(claim(Clocked), solver).status == "proven"


def test_a_wrong_claim_of_a_clock_of_its_own_fails_in_the_simulator_too() -> None:
    result = judged(claim(lambda: Clocked(3)))
    assert (result.status, result.reason) == ("failed", "holds is 0 in tick 5")
    assert result.counterexample is None


def test_a_late_cover_is_reached_by_a_run() -> None:
    assert judged(claim(NeverAbove, cover=Run(300))).status == "proven"


FIRST = inputs.CLAIMS[0]
EARLY = FIRST.mutants[0]
SAME = Mutant("same", INPUTS, "range(self._filter_ticks + 1)", "range(self._filter_ticks + 2)")


def test_a_mutant_is_rejected_by_a_search_and_by_a_run() -> None:
    ran = replace(EARLY, name="ran", rejected=Run(2000))
    result = judged(replace(FIRST, mutants=(EARLY, ran)), mutants=True)
    assert result.status == "proven"
    assert [mutant.rejected for mutant in result.mutants] == [True, True]


@pytest.mark.parametrize("rejected", [Search(), Run(2000)])
def test_a_mutant_that_is_no_worse_is_not_rejected_and_spoils_the_claim(rejected: Any) -> None:
    same = replace(SAME, rejected=rejected)
    result = judged(replace(FIRST, mutants=(EARLY, same)), mutants=True)
    assert (result.status, result.reason) == ("failed", "counts as unproven: same not rejected")
    assert [mutant.rejected for mutant in result.mutants] == [True, False]


def test_a_mutant_beyond_the_search_is_not_rejected() -> None:
    """Its induction would not close, which rejects nothing."""
    short = replace(EARLY, name="short", rejected=Search(3))
    result = judged(replace(FIRST, mutants=(EARLY, short)), mutants=True)
    assert result.mutants[1].reason == "holds for 3 ticks"
    assert result.status == "failed"


def test_a_mutant_is_not_rejected_by_what_fails_without_it_too() -> None:
    result = judged(replace(WRONG, mutants=FIRST.mutants[:2]), mutants=True)
    assert [mutant.reason for mutant in result.mutants] == ["fails without the mutant too"] * 2


class Saying(Tools):
    """Solvers that say what a test wants."""

    code, said = 0, ""

    def smtbmc(self, _arguments: list[str], _folder: Path) -> tuple[int, str]:
        return self.code, self.said


@pytest.mark.parametrize(
    ("code", "said"),
    [
        (0, ""),
        (0, "##  Status: UNKNOWN"),
        (1, "##  Status: PASSED"),
        (0, "##  Status: FAILED"),
        (2, "##  Status: PASSED"),
        (0, "##  Status: PASSED\nTraceback"),
        (-9, ""),
    ],
)
def test_an_odd_answer_is_never_a_proof(code: int, said: str) -> None:
    tools = Saying()
    tools.code, tools.said = code, said
    result = prove([FIRST], tools, mutants=True)[0]
    assert result.status == "failed"
    assert result.reason.startswith(f"yices ended with code {code}: ")
    assert not any(mutant.rejected for mutant in result.mutants)


def test_no_answer_in_time_is_never_a_proof() -> None:
    result = prove([claim(NeverAbove)], Tools(timeout_s=0.01))[0]
    assert (result.status, result.reason) == ("failed", "no answer in 0.01 s")


class Late(Tools):
    """A solver that leaves an induction open and then is too slow to refute the claim."""

    def smtbmc(self, arguments: list[str], folder: Path) -> tuple[int, str]:
        if "-i" in arguments:
            (folder / "claim_step.vcd").write_text("the step")
            return 1, "##  Status: FAILED"
        if "25" in arguments:
            raise TimeoutError("no answer")
        return 0, "##  Status: PASSED"


def test_an_open_induction_is_told_although_the_search_for_a_counterexample_takes_too_long() -> (
    None
):
    (result,) = prove([claim(NeverAbove)], Late())
    assert result.reason.startswith("the induction does not close at k = 1")
    assert result.step == "the step"


def test_results_come_in_the_order_of_the_claims_and_are_told_as_they_end() -> None:
    claims = [claim(NeverAbove), replace(WRONG)]
    told: list[Result] = []
    results = prove(claims, Tools(), jobs=2, done=told.append)
    assert [result.claim for result in results] == claims
    assert sorted(map(id, told)) == sorted(map(id, results))


def test_a_claim_says_what_is_wrong_with_it() -> None:
    for given, says in (
        ({"requirements": ("ODO9",)}, 'a requirement must be as "ODO-1", not "ODO9"'),
        ({"mutants": FIRST.mutants[:1]}, "at least two mutants by name"),
        ({"mutants": FIRST.mutants[:1] * 2}, "at least two mutants by name"),
    ):
        with pytest.raises(ValueError, match=says):
            claim(NeverAbove, **given)
    with pytest.raises(ValueError, match=r'must be as "odometer\.sums", not "Sums"'):
        replace(FIRST, name="Sums")
    with pytest.raises(ValueError, match="k must be at least 1, not 0"):
        Induction(0)
