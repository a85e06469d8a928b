"""The command that exports a core."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["export_"]


def export_(
    target: Annotated[str, typer.Argument(help="odometer, position_link, vital_output, unit.")],
    format: Annotated[
        str, typer.Option(help="verilog, rtlil, core, systemrdl, c-header, html.")
    ] = "core",
    bus: Annotated[
        str, typer.Option(help="Its registers are on: none, axi4-lite, wishbone, local, uart.")
    ] = "none",
    config: Annotated[
        str | None,
        typer.Option(help="metro, maglev: as in that unit; or a TOML file of the function's own."),
    ] = None,
    fpga: Annotated[int, typer.Option(help="1 or 2: of the unit, or the channel.")] = 1,
    out: Annotated[Path, typer.Option(help="Write the files there.")] = Path("build/export"),
) -> None:
    """A function, or an FPGA of the unit, as files for another project."""
    # Here, since no other command needs all gateware.
    from railgate.fpga.export import core, export

    for path in export(core(target, config=config, bus=bus, fpga=fpga), format, out):
        print(f"wrote {path}")
