"""What a proof came to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from railgate.proving.claim import Bounded, Claim
from railgate.waves import Trace

__all__ = ["Rejection", "Result"]


@dataclass(frozen=True)
class Rejection:
    """Whether a mutant is rejected (None: it was not tried), and in which tick or why not."""

    name: str
    rejected: bool | None = None
    reason: str = ""


@dataclass(frozen=True, kw_only=True)
class Result:
    """What a claim's proof came to.

    status: proven (for all time), bounded or failed. reason: why it is no more than that.
    mutants: one each, in the claim's order. counterexample: a stimulus from reset that fails the
    claim. step: the VCD of an induction step that fails, from a state that need not be reachable.
    """

    claim: Claim
    status: str
    reason: str
    seconds: float
    mutants: tuple[Rejection, ...]
    counterexample: Trace | None = None
    step: str | None = None

    @property
    def failed(self) -> bool:
        return self.status == "failed"

    def as_json(self) -> dict[str, Any]:
        """As `railgate prove --json` prints it."""
        method = self.claim.method
        return {
            "name": self.claim.name,
            "claim": self.claim.claim,
            "requirements": list(self.claim.requirements),
            "method": str(method),
            "status": self.status,
            "bound": method.depth if isinstance(method, Bounded) else None,
            "seconds": round(self.seconds, 2),
            "mutants": [{"name": m.name, "rejected": m.rejected} for m in self.mutants],
            "reason": self.reason,
        }
