"""A core as files."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterable, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from railgate.fpga.export.bench import bench
from railgate.fpga.export.borders import Borders, borders
from railgate.fpga.export.buses import NONE
from railgate.fpga.export.constraints import CONSTRAINTS, Constrained
from railgate.fpga.export.header import described, heading
from railgate.fpga.export.netlist import netlist
from railgate.fpga.export.targets import Core
from railgate.fpga.export.vectors import vectors
from railgate.fpga.export.verilog import translate
from railgate.fpga.scratch import scratch
from railgate.registers.export import c_header, html, systemrdl

__all__ = ["FORMATS", "export"]

TEMPLATES = Environment(
    loader=PackageLoader(__package__),
    undefined=StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
    keep_trailing_newline=True,
    autoescape=False,
)
Texts = Mapping[str, str]
"""By the files' names."""


def export(core: Core, format: str, folder: Path) -> list[Path]:
    """Write the core into the folder, as one of FORMATS; the same bytes each time.

    All files come into being whole, in place of those that were there. Returns their paths. Raises
    ValueError.
    """
    if format not in FORMATS:
        raise ValueError(f'format must be one of {", ".join(FORMATS)}, not "{format}"')
    with scratch(folder, "export") as at:
        FORMATS[format](core, at)
        return [_moved(made, folder / made.name) for made in sorted(at.iterdir())]


def _moved(made: Path, to: Path) -> Path:
    if made.is_dir() and to.is_dir():
        shutil.rmtree(to)
    return made.replace(to)


def _rtlil(core: Core, folder: Path) -> None:
    text = _comment("#", heading(core)) + "\n" + netlist(core.component, core.name)
    (folder / f"{core.name}.il").write_text(text, encoding="utf-8")


def _verilog(core: Core, folder: Path) -> str:
    """With waivers and constraints; returns the Verilog."""
    translated = translate(netlist(core.component, core.name), core.name)
    found = borders(translated.flat)
    verilog = _comment("//", described(core, found)) + "\n" + translated.verilog
    texts = {"v": verilog, "vlt": _filled("waivers.vlt", core, "//"), **_constraints(core, found)}
    for suffix, text in texts.items():
        (folder / f"{core.name}.{suffix}").write_text(text, encoding="utf-8")
    return verilog


def _constraints(core: Core, found: Borders) -> dict[str, str]:
    of = Constrained({f"{domain}_clk": hz for domain, hz in core.hz.items()}, found, core.still)
    return {
        suffix: "\n".join((_comment("#", heading(core)), *lines(of))) + "\n"
        for suffix, lines in CONSTRAINTS.items()
    }


def _core(core: Core, folder: Path) -> None:
    verilog = _verilog(core, folder)
    simulated = core.design is not None
    text = _filled("fusesoc.core", core, "#", simulated=simulated, version=version("railgate"))
    (folder / f"{core.name}.core").write_text(text, encoding="utf-8")
    if simulated:
        golden = vectors(core)
        text = _filled("bench.sv", core, "//", **bench(core, golden, verilog))
        (folder / f"{core.name}_tb.sv").write_text(text, encoding="utf-8")
        (folder / f"{core.name}.vectors").write_text(golden.text(), encoding="utf-8")
    if core.bus != NONE:
        _systemrdl(core, folder)


def _systemrdl(core: Core, folder: Path) -> None:
    text = _comment("//", heading(core)) + "\n" + systemrdl(core.map)
    (folder / f"{core.name}.rdl").write_text(text, encoding="utf-8")


def _filled(template: str, core: Core, mark: str, **told: Any) -> str:
    head = _comment(mark, heading(core)).rstrip("\n")
    return TEMPLATES.get_template(template).render(core=core, heading=head, **told)


def _comment(mark: str, lines: Iterable[str]) -> str:
    return "".join(f"{mark} {line}".rstrip() + "\n" for line in lines)


FORMATS: Mapping[str, Callable[[Core, Path], object]] = {
    "verilog": _verilog,
    "rtlil": _rtlil,
    "core": _core,
    "systemrdl": _systemrdl,
    "c-header": lambda core, folder: c_header(core.map, folder / f"{core.name}.h"),
    "html": lambda core, folder: html(core.map, folder / f"{core.name}_registers"),
}
"""By name, what writes into a folder."""
