"""What is proven of the vital output's gateware."""

from railgate.proving import Claim
from railgate.vital_output.proofs import (
    agreement,
    beside,
    checking,
    clocks,
    commands,
    driving,
    life,
    output,
    timekeeping,
    together,
    upsets,
    voting,
)

__all__ = ["CLAIMS"]

CLAIMS: tuple[Claim, ...] = (
    *checking.CLAIMS,
    *commands.CLAIMS,
    *timekeeping.CLAIMS,
    *voting.CLAIMS,
    *life.CLAIMS,
    *agreement.CLAIMS,
    *output.CLAIMS,
    *driving.CLAIMS,
    *upsets.CLAIMS,
    *clocks.CLAIMS,
    *beside.CLAIMS,
    *together.CLAIMS,
)
