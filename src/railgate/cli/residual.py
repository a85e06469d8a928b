"""The command that shows what the command frame's CRC detects."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from railgate.cli.output import present, running

__all__ = ["residual_"]


def residual_(
    outputs: Annotated[int, typer.Option(help="Of the vital output: they make the frame.")] = 16,
    polynomial: Annotated[
        str, typer.Option(help="Of the CRC, shown beside Ethernet's own, without its x^32.")
    ] = "0xf4acfb13",
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object and nothing else.")
    ] = False,
    out: Annotated[Path | None, typer.Option(help="Write tables and a picture there.")] = None,
) -> None:
    """What the command frame's CRC detects, and how likely an error passes it."""
    # Here, since numba and the enumerations are needed by no other command of the vital output.
    from railgate.vital_output.residual import ETHERNET, compare, show
    from railgate.vital_output.spec import Config

    polynomials = dict.fromkeys((_number(polynomial), ETHERNET))
    configs = [Config(outputs=outputs, polynomial=each) for each in polynomials]
    with running("enumeration") as progress:
        comparison = compare(configs, progress)
    paths = []
    if out:
        from railgate.vital_output.residual.record import record  # matplotlib is slow to start

        paths = record(comparison, out)
    present(comparison.as_json() if json else show(comparison), paths)


def _number(text: str) -> int:
    try:
        return int(text, 0)
    except ValueError:
        raise ValueError(f"--polynomial must be a number as 0xf4acfb13, not {text!r}") from None
