"""Formal proofs of gateware: claims, their monitors, and the provers that judge them."""

from railgate.proving.claim import TICK, Bounded, Claim, Induction, Mutant, Run, Search
from railgate.proving.internals import Internals
from railgate.proving.monitor import Monitor

__all__ = [
    "TICK",
    "Bounded",
    "Claim",
    "Induction",
    "Internals",
    "Monitor",
    "Mutant",
    "Run",
    "Search",
]
