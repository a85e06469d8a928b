"""The command that proves."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from railgate import quantity
from railgate.cli.output import counted, present

if TYPE_CHECKING:
    from railgate.proving.result import Result

__all__ = ["prove_"]


def prove_(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="NAME", help="Claims, or how they begin.")
    ] = None,
    mutants: Annotated[
        bool, typer.Option("--mutants", help="Try that each broken variant is rejected too.")
    ] = False,
    fast: Annotated[
        bool, typer.Option("--fast", help="Only the claims that take less than 20 s each.")
    ] = False,
    solver: Annotated[str, typer.Option(help="yices, z3: who answers.")] = "yices",
    timeout: Annotated[str, typer.Option(help="The longest time for one answer.")] = "900s",
    jobs: Annotated[
        int, typer.Option(min=1, help="Claims at a time.", show_default="one a core")
    ] = os.cpu_count() or 1,
    replay: Annotated[
        Path | None, typer.Option(help="Only run the claim's gateware, in pysim, driven by a file.")
    ] = None,
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON array and nothing else.")
    ] = False,
    out: Annotated[Path, typer.Option(help="Write counterexamples there.")] = Path("build/prove"),
) -> None:
    """Prove what is claimed of the gateware; exit code 1 where a claim fails."""
    # Here, since no other command needs the solvers' side.
    from railgate.evidence.claims import chosen
    from railgate.evidence.digests import digests
    from railgate.evidence.results import keep_proof
    from railgate.proving.counterexample import replay as run_again
    from railgate.proving.prover import prove
    from railgate.proving.table import record
    from railgate.proving.tools import Tools

    claims = [claim for claim in chosen(names or ()) if claim.fast or not fast]
    if not claims:
        raise ValueError("--fast leaves no claim to prove")
    if replay is not None:
        if len(claims) != 1:
            raise ValueError(f"--replay needs one claim, not {len(claims)}")
        fall = run_again(claims[0], replay)
        print(f"{claims[0].name}: {fall or 'holds throughout'}")
        raise typer.Exit(int(fall is not None))
    tools = Tools(solver, float(quantity.time_s(timeout)))
    on = digests()
    with counted("proving", len(claims)) as done:

        def ended(result: Result) -> None:
            keep_proof(result, on)
            done()

        results = prove(claims, tools, mutants=mutants, jobs=jobs, done=ended)
    _present(results, [record(result, out) for result in results], json)
    raise typer.Exit(int(any(result.failed for result in results)))


def _present(results: Sequence[Result], files: Sequence[list[Path]], as_json: bool) -> None:
    from railgate.proving.table import show

    told = [
        result.as_json() | {"files": [str(path) for path in written]}
        for result, written in zip(results, files, strict=True)
    ]
    present(told if as_json else show(results), [path for written in files for path in written])
