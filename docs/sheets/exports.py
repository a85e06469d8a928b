"""The register maps for other tools, beside the pages."""

from __future__ import annotations

from pathlib import Path

from sphinx.application import Sphinx

from railgate.registers.export import c_header, html, systemrdl
from railgate.unit.config import Unit
from railgate.unit.registers import registers

__all__ = ["maps"]


def maps(app: Sphinx, error: Exception | None) -> None:
    """SystemRDL and C header of both FPGAs, in `maps`, at the build's end.

    Pages of PeakRDL's are of FPGA 1 alone, whose map has all that FPGA 2's has, at the same places.
    """
    if error or app.builder.name != "html":
        return
    folder = Path(app.outdir) / "maps"
    folder.mkdir(exist_ok=True)
    for fpga in (1, 2):
        map_ = registers(Unit(), fpga)
        (folder / f"fpga_{fpga}.rdl").write_text(systemrdl(map_), encoding="utf-8")
        c_header(map_, folder / f"fpga_{fpga}.h")
    html(registers(Unit(), 1), folder / "fpga_1")
