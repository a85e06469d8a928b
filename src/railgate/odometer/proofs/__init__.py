"""What is proven of the odometer's gateware."""

from railgate.odometer.proofs import inputs
from railgate.proving import Claim

__all__ = ["CLAIMS"]

CLAIMS: tuple[Claim, ...] = inputs.CLAIMS
