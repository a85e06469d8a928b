"""Claims and requirements, from where proofs and tests are found."""

from __future__ import annotations

from railgate.evidence.claims import claims
from railgate.evidence.matrix import KINDS, Row
from railgate.evidence.tracing import trace
from railgate.proving import Bounded
from sheets.markdown import table

__all__ = ["bounded", "claimed", "required"]


def claimed(prefix: str) -> str:
    """A table of the claims whose name begins so: what is claimed, and how it is shown."""
    rows = [
        (f"`{c.name}`", c.claim, ", ".join(c.requirements), str(c.method), str(len(c.mutants)))
        for c in claims()
        if c.name.startswith(prefix)
    ]
    return table(("claim", "what it says", "shows", "how", "mutants"), rows)


def bounded(_: str) -> str:
    """The claims that are shown for the first ticks only, and why."""
    rows = [
        (f"`{claim.name}`", str(claim.method), claim.method.because)
        for claim in claims()
        if isinstance(claim.method, Bounded)
    ]
    return table(("claim", "holds for", "why not for all time"), rows)


def required(prefix: str) -> str:
    """A table of the requirements whose name begins so, with what speaks for each."""
    rows = [
        (row.requirement.name, row.requirement.sentence, *_told(row))
        for row in trace().rows
        if row.requirement.name.startswith(prefix)
    ]
    return table(("", "requirement", "tests", "sweeps", "proofs"), rows)


def _told(row: Row) -> tuple[str, str, str]:
    if row.requirement.planned:
        return "not built yet", "", ""
    gateware, tests, proofs, sweeps = (row.of(kind) for kind in KINDS)
    del gateware  # a citation shows nothing
    named = ", ".join(f"`{each.name}`" for each in proofs)
    return str(len(tests) or ""), str(len(sweeps) or ""), named
