"""What is proven of the position link's gateware."""

from railgate.position_link.proofs import timing, words
from railgate.proving import Claim

__all__ = ["CLAIMS"]

CLAIMS: tuple[Claim, ...] = (*timing.CLAIMS, *words.CLAIMS)
