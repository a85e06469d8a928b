"""From each requirement to what shows it, and how that last went (SYS-4)."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from railgate.evidence.citations import citations
from railgate.evidence.claims import claims
from railgate.evidence.digests import TESTS, digests
from railgate.evidence.marks import Marks, marked
from railgate.evidence.matrix import KINDS, Evidence, Matrix, Row
from railgate.evidence.requirements import REQUIREMENTS
from railgate.evidence.results import RESULTS, Proved, Ran, read_proofs, read_tests
from railgate.proving import Claim

__all__ = ["trace"]

Speaking = tuple[Evidence, Sequence[str]]
"""Something, and the requirements that it speaks for."""


def trace(results: Path = RESULTS, tests: Path = TESTS) -> Matrix:
    """The matrix as it is now.

    results: where the last results were kept. tests: a checkout's; where there is no such folder,
    the tests that have results count. Raises ValueError, as for a requirement that is none.
    """
    now = digests()
    ran, proved = read_tests(results), read_proofs(results)
    there = marked(tests) if tests.is_dir() else _recorded(ran)
    found: dict[str, list[Evidence]] = {requirement.name: [] for requirement in REQUIREMENTS}
    for each, names in [*_gateware(), *_tests(there, ran, now), *_proofs(proved, now)]:
        for name in names:
            if name not in found:
                raise ValueError(f"{each.name} speaks for {name}, which is no requirement")
            found[name].append(each)
    rows = (Row(each, tuple(sorted(found[each.name], key=_rank))) for each in REQUIREMENTS)
    return Matrix(tuple(rows), time.time())


def _rank(each: Evidence) -> int:
    return KINDS.index(each.kind)


def _recorded(ran: Mapping[str, Ran]) -> dict[str, Marks]:
    return {name: Marks(test.shows, test.sweep) for name, test in ran.items()}


def _gateware() -> Iterator[Speaking]:
    for file, cited in citations().items():
        yield Evidence("gateware", file, "", "cited"), cited


def _tests(
    there: Mapping[str, Marks], ran: Mapping[str, Ran], now: Mapping[str, str]
) -> Iterator[Speaking]:
    for name, marks in there.items():
        says = name.rpartition("::test_")[2].replace("_", " ")
        each = Evidence("sweep" if marks.sweep else "test", name, says, "not run")
        yield _ended(each, ran[name], now) if name in ran else each, marks.shows


def _ended(each: Evidence, ran: Ran, now: Mapping[str, str]) -> Evidence:
    outcomes = [case.outcome for case in ran.cases.values()]
    passed = outcomes.count("passed")
    result = _result("failed" in outcomes, passed == ran.of, ran.on, now)
    told = outcomes[0] if ran.of == 1 else f"{passed} of {ran.of or 'some'} cases"
    at = min(case.at for case in ran.cases.values())
    return replace(each, result=result, told=told, at=at)


def _proofs(proved: Mapping[str, Proved], now: Mapping[str, str]) -> Iterator[Speaking]:
    for claim in claims():
        each = Evidence("proof", claim.name, claim.claim, "not run")
        if claim.name in proved:
            each = _tried(each, claim, proved[claim.name], now)
        yield each, claim.requirements


def _tried(each: Evidence, claim: Claim, proved: Proved, now: Mapping[str, str]) -> Evidence:
    of = len(claim.mutants)
    result = _result(proved.status == "failed", proved.rejected == of, proved.on, now)
    tried = "none" if proved.rejected is None else str(proved.rejected)
    told = f"{proved.status}, {claim.method}; {tried} of {of} mutants rejected"
    return replace(each, result=result, told=told, at=proved.at)


def _result(failed: bool, whole: bool, on: Mapping[str, str], now: Mapping[str, str]) -> str:
    if failed:
        return "failed"
    if any(now.get(name, digest) != digest for name, digest in on.items()):
        return "stale"
    return "passed" if whole else "incomplete"
