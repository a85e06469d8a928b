"""Every claim of every function: well made, and, of the fast ones, proven with their mutants."""

import pytest

from railgate.evidence.claims import chosen, claims
from railgate.proving import Claim
from railgate.proving.mutation import elaborated
from railgate.proving.netlist import netlist
from railgate.proving.prover import prove
from railgate.proving.tools import Tools

ALL = claims()
NAMES = [claim.name for claim in ALL]


@pytest.mark.parametrize("claim", [c for c in ALL if c.fast], ids=lambda claim: claim.name)
def test_the_fast_claims_are_proven_and_reject_their_mutants(claim: Claim) -> None:
    (result,) = prove([claim], Tools(), mutants=True)
    assert not result.failed, (result.reason, result.mutants)
    assert [mutant.rejected for mutant in result.mutants] == [True] * len(claim.mutants)


@pytest.mark.slow
@pytest.mark.parametrize("claim", ALL, ids=lambda claim: claim.name)
def test_every_mutant_has_another_netlist(claim: Claim) -> None:
    texts = [netlist(elaborated(claim, mutant), helped=True) for mutant in (None, *claim.mutants)]
    assert len(set(texts)) == len(texts)


@pytest.mark.shows("SYS-4")
def test_names_are_unique_and_each_claim_shows_a_requirement() -> None:
    assert len(set(NAMES)) == len(NAMES)
    assert all(claim.requirements and claim.claim.endswith(".") for claim in ALL)


def test_claims_are_chosen_by_name_and_by_how_names_begin() -> None:
    assert chosen([]) == ALL
    assert [claim.name for claim in chosen(["odometer.inputs"])] == [
        "odometer.inputs-reject",
        "odometer.inputs-delay",
    ]
    assert [claim.name for claim in chosen(["odometer.inputs-delay", "odometer.inputs-r"])] == [
        "odometer.inputs-reject",
        "odometer.inputs-delay",
    ]
    with pytest.raises(ValueError, match=r'no claim "wheel"; there are: odometer\.'):
        chosen(["odometer", "wheel"])
