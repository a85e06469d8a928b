"""The command that places and routes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from railgate.cli.options import limit_s
from railgate.cli.output import counted, present

__all__ = ["report_"]


def report_(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="TARGET", help="Functions or peers; all without.")
    ] = None,
    part: Annotated[
        list[str] | None,
        typer.Option(help="ECP5-25F-6 without it; may be repeated."),
    ] = None,
    seeds: Annotated[int, typer.Option(min=1, help="Placements of each, with seeds 1, 2, ….")] = 5,
    limit: Annotated[str, typer.Option(help="The longest time for one of them.")] = "1800s",
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON array and nothing else.")
    ] = False,
    out: Annotated[Path, typer.Option(help="Keep figures and placements there.")] = Path("build"),
) -> None:
    """Place and route every function: what clock it reaches, what it takes of a real part."""
    # Here, since no other command needs all gateware.
    from railgate.fpga.parts import REFERENCE
    from railgate.fpga.report import report
    from railgate.fpga.table import show
    from railgate.fpga.targets import chosen

    targets = chosen(names or ())
    seconds = limit_s(limit)
    parts = list(dict.fromkeys(part or [REFERENCE]))
    with counted("placing", len(parts) * len(targets) * seeds) as placed:
        rows = report(targets, parts, seeds=seeds, limit_s=seconds, folder=out, placed=placed)
    present([row.as_json() for row in rows] if json else show(rows), [out / "fpga.json"])
    raise typer.Exit(int(any(row.failed for row in rows)))
