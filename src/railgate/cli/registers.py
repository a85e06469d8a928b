"""The command that shows and exports the register map."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from railgate.cli.output import present

__all__ = ["registers_"]

FORMATS = ("table", "systemrdl", "c-header", "html")


def registers_(
    unit: Annotated[str, typer.Option(help="Whose: metro, maglev.")] = "metro",
    fpga: Annotated[int, typer.Option(help="1, with the position link, or 2.")] = 1,
    format: Annotated[str, typer.Option(help=f"{', '.join(FORMATS)}.")] = "table",
    json: Annotated[
        bool, typer.Option("--json", help="Print the table as one JSON array.")
    ] = False,
    out: Annotated[
        Path | None, typer.Option(help="The file of the C header, the folder of the pages.")
    ] = None,
) -> None:
    """The register map of an on-board unit's FPGA, as it is or as files for other tools."""
    # Here, since no other command needs the exports.
    from railgate.registers.export import c_header, html, rows, show, systemrdl
    from railgate.unit.config import UNITS
    from railgate.unit.registers import registers

    if unit not in UNITS:
        raise ValueError(f'unit must be one of {", ".join(UNITS)}, not "{unit}"')
    if format not in FORMATS:
        raise ValueError(f'format must be one of {", ".join(FORMATS)}, not "{format}"')
    map_ = registers(UNITS[unit](), fpga)
    if format == "table":
        present(rows(map_) if json else show(map_), [])
    elif format == "systemrdl":
        print(systemrdl(map_), end="")
    elif out is None:
        raise ValueError(f"--format {format} needs --out, where it is written")
    elif format == "c-header":
        c_header(map_, out)
        print(f"wrote {out}")
    else:
        html(map_, out)
        print(f"wrote {out / 'index.html'}")
