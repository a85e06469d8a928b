"""What is proven of the vital output's gateware."""

from railgate.proving import Claim
from railgate.vital_output.proofs import output

__all__ = ["CLAIMS"]

CLAIMS: tuple[Claim, ...] = (*output.CLAIMS,)
