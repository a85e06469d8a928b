"""The command that traces requirements."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from railgate.cli.output import present

__all__ = ["evidence_"]


def evidence_(
    strict: Annotated[
        bool, typer.Option("--strict", help="Exit code 1 also where one is amber.")
    ] = False,
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object and nothing else.")
    ] = False,
    out: Annotated[Path, typer.Option(help="Write the matrix as a page and as JSON there.")] = Path(
        "build/evidence"
    ),
) -> None:
    """Each requirement with what shows it, and how that last went; exit code 1 where one is red."""
    # Here, since no other command needs all claims and the page.
    from railgate.evidence.matrix import Status
    from railgate.evidence.record import record
    from railgate.evidence.table import show
    from railgate.evidence.tracing import trace

    matrix = trace()
    files = record(matrix, out)
    present(matrix.as_json() if json else show(matrix), files)
    bad = [Status.RED, Status.AMBER] if strict else [Status.RED]
    raise typer.Exit(int(any(matrix.having(status) for status in bad)))
