"""The command that shows the register map."""

from __future__ import annotations

from typing import Annotated

import typer

from railgate.cli.output import present

__all__ = ["registers_"]


def registers_(
    unit: Annotated[str, typer.Option(help="Whose: metro, maglev.")] = "metro",
    fpga: Annotated[int, typer.Option(help="1, with the position link, or 2.")] = 1,
    json: Annotated[
        bool, typer.Option("--json", help="Print one JSON array and nothing else.")
    ] = False,
) -> None:
    """The register map of an on-board unit's FPGA, field by field."""
    # Here, since no other command needs the exports.
    from railgate.registers.export import rows, show
    from railgate.unit.config import unit_named
    from railgate.unit.registers import registers

    map_ = registers(unit_named(unit), fpga)
    present(rows(map_) if json else show(map_), [])
