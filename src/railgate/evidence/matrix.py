"""The traceability matrix: each requirement with what shows it, and how that stands."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Any

from railgate.evidence.requirements import Requirement

__all__ = ["KINDS", "Evidence", "Matrix", "Row", "Status"]

KINDS = ("gateware", "test", "proof", "sweep")
"""Gateware cites the requirement, which shows nothing yet; the others have results."""


class Status(Enum):
    """Of a requirement, from what shows it.

    GREEN: all of it passed, on the sources as they are. AMBER: nothing failed, but something was
    not run, or not wholly, or on other sources. RED: nothing shows it, or something failed.
    GREY: it is not built yet.
    """

    GREEN = "green"
    AMBER = "amber"
    RED = "red"
    GREY = "grey"


@dataclass(frozen=True)
class Evidence:
    """One thing that speaks for a requirement.

    kind: one of KINDS. name: a file of gateware, a test, a claim. says: what it shows, in words,
    none of gateware. result: `cited` of gateware; else `passed`, `failed`, `incomplete` (some of
    its cases, or its mutants, were not tried), `stale` (it passed, on other sources) or `not run`.
    told: what it came to, in words. at: the end of its last run, Unix time.
    """

    kind: str
    name: str
    says: str
    result: str
    told: str = ""
    at: float | None = None


@dataclass(frozen=True)
class Row:
    """A requirement and its evidence, in the order of KINDS."""

    requirement: Requirement
    evidence: tuple[Evidence, ...]

    @property
    def status(self) -> Status:
        results = {each.result for each in self.evidence} - {"cited"}
        if self.requirement.planned:
            return Status.GREY
        if not results or "failed" in results:
            return Status.RED
        return Status.GREEN if results == {"passed"} else Status.AMBER

    @property
    def oldest(self) -> float | None:
        """The earliest of the last runs' ends, Unix time; None where nothing was run."""
        return min((each.at for each in self.evidence if each.at is not None), default=None)

    def of(self, kind: str) -> list[Evidence]:
        """Its evidence of one kind."""
        return [each for each in self.evidence if each.kind == kind]


@dataclass(frozen=True)
class Matrix:
    """All requirements. at: when it was made, Unix time."""

    rows: tuple[Row, ...]
    at: float

    def having(self, status: Status) -> list[Row]:
        """The requirements of one status."""
        return [row for row in self.rows if row.status is status]

    def as_json(self) -> dict[str, Any]:
        """As `railgate evidence --json` prints it."""
        return {
            row.requirement.name: {
                "status": row.status.value,
                "requirement": row.requirement.sentence,
                "evidence": [self._told(each) for each in row.evidence],
            }
            for row in self.rows
        }

    def _told(self, each: Evidence) -> dict[str, Any]:
        return {
            "kind": each.kind,
            "name": each.name,
            "says": each.says,
            "result": each.result,
            "told": each.told,
            "age_s": None if each.at is None else round(self.at - each.at),
        }
