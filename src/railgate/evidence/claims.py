"""All claims of all functions, by name."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module

from railgate.proving import Claim

__all__ = ["PROOFS", "chosen", "claims"]

PROOFS = (
    "railgate.odometer.proofs",
    "railgate.position_link.proofs",
    "railgate.vital_output.proofs",
)
"""The packages that hold claims, each as its CLAIMS."""


def claims() -> tuple[Claim, ...]:
    """All there are, in the order of PROOFS."""
    return tuple(claim for package in PROOFS for claim in import_module(package).CLAIMS)


def chosen(names: Sequence[str]) -> tuple[Claim, ...]:
    """Those whose name begins with one of `names`, all where there is none.

    Raises ValueError for a name with which none begins.
    """
    there = claims()
    for name in names:
        if not any(claim.name.startswith(name) for claim in there):
            listed = ", ".join(claim.name for claim in there)
            raise ValueError(f'no claim "{name}"; there are: {listed}')
    return tuple(c for c in there if not names or any(c.name.startswith(n) for n in names))
