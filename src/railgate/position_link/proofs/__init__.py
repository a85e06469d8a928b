"""What is proven of the position link's gateware."""

from railgate.position_link.proofs import age, answers, clock, delivery, faults, timeout
from railgate.proving import Claim

__all__ = ["CLAIMS"]

CLAIMS: tuple[Claim, ...] = (
    *clock.CLAIMS,
    *delivery.CLAIMS,
    *timeout.CLAIMS,
    *answers.CLAIMS,
    *faults.CLAIMS,
    *age.CLAIMS,
)
