"""What is proven of the vital output's gateware.

Not yet among them, since their mutants are not all rejected or their depth is not settled:
`checking` (a frame's check) and `together` (two channels, on `pair`).
"""

from railgate.proving import Claim
from railgate.vital_output.proofs import (
    agreement,
    clocks,
    commands,
    driving,
    life,
    output,
    timekeeping,
    voting,
)

__all__ = ["CLAIMS"]

CLAIMS: tuple[Claim, ...] = (
    *commands.CLAIMS,
    *timekeeping.CLAIMS,
    *voting.CLAIMS,
    *life.CLAIMS,
    *agreement.CLAIMS,
    *output.CLAIMS,
    *driving.CLAIMS,
    *clocks.CLAIMS,
)
