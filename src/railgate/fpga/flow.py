"""From a netlist to figures: synthesis, then place and route once a seed, all of it kept."""

from __future__ import annotations

import json
import tempfile
from collections import Counter
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from railgate.fpga.gateware import Sources
from railgate.fpga.gateware.pins import INSIDE, TOP
from railgate.fpga.parts import Area, Part, part
from railgate.fpga.tools import UnplacedError, nextpnr, versions, yosys
from railgate.waves import replacing

__all__ = [
    "FULL",
    "NETLIST",
    "Flow",
    "Netlist",
    "cells",
    "check_fits",
    "fmax_mhz",
    "taken",
]

FULL = 0.75
"""The part of a device's LUTs or flip-flops above which nextpnr may not end."""

VERILOG = "design.v"
NETLIST = "netlist.v"
"""The cells that are placed, as Verilog."""

# The component stays a module of its own until its cells are counted; between its registers and
# those of the pins there is nothing to optimise.
SYNTHESIS = f"""
read_rtlil design.il
read_verilog {VERILOG}
setattr -mod -set keep_hierarchy 1 {INSIDE}
{{synthesis}} -top {TOP}
tee -q -o cells.json stat -json
write_verilog -noattr {NETLIST}
setattr -mod -unset keep_hierarchy {INSIDE}
flatten
opt_clean
write_json placeable.json
"""

# One set of flags for all: a clock that none reaches, so that all are driven as hard as can be.
PLACEMENT = ("--freq", "600", "--timing-allow-fail", "--json", "placeable.json")


@dataclass(frozen=True)
class Netlist:
    """What a synthesised netlist takes. inside: the component alone. whole: with its pins."""

    inside: Area
    whole: Area


class Flow:
    """One design on its way onto a part.

    kept: the folder that keeps what tools made, in a folder for each design, part and version of
    the tools: nothing is made twice, also after an interruption. limit_s: the longest time for one
    call of a tool. folder: in `kept`, what is made of this design. Raises ValueError where a tool
    is missing, or where a part needs pins.
    """

    def __init__(self, name: str, sources: Sources, on: str, kept: Path, limit_s: float) -> None:
        self._name, self._on, self._part = name, on, part(on, free_pins=True)
        self._sources = sources
        self._limit_s = limit_s
        flags = SYNTHESIS, self._part.synthesis, PLACEMENT, self._part.options
        told = tuple(sources), flags, versions(self._part.nextpnr)
        digest = sha256(repr(told).encode()).hexdigest()[:12]
        self.folder = kept / f"{name}-{on}-{digest}"

    def synthesise(self) -> Netlist:
        """What it takes. Raises UnplacedError where Yosys fails or takes too long."""
        if not self.folder.exists():
            self._make()
        areas = taken(self.folder / "cells.json", self._part)
        return Netlist(areas[INSIDE], sum(areas.values(), Area()))

    def place(self, seed: int) -> float:
        """The clock that it reaches with a seed, in MHz.

        Raises UnplacedError where it takes more of the part than FULL, and as `synthesise`.
        """
        check_fits(self._name, self.synthesise().whole, self._on)
        report = self.folder / f"seed-{seed}.json"
        if not report.exists():
            with replacing(report) as new:
                arguments = (*self._part.options, *PLACEMENT, "--seed", str(seed))
                arguments += ("--report", new.name)
                nextpnr(self._part.nextpnr, arguments, self.folder, self._limit_s)
        return fmax_mhz(_read(report))

    def _make(self) -> None:
        """Synthesise; the folder comes into being with all in it."""
        try:
            self.folder.parent.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryDirectory(dir=self.folder.parent) as scratch:
                made = Path(scratch) / "made"
                made.mkdir()
                (made / "design.il").write_text(self._sources.rtlil, encoding="utf-8")
                (made / VERILOG).write_text(self._sources.verilog, encoding="utf-8")
                yosys(SYNTHESIS.format(synthesis=self._part.synthesis), made, self._limit_s)
                try:
                    made.rename(self.folder)
                except OSError:
                    if not self.folder.is_dir():  # made by another process meanwhile
                        raise
        except OSError as error:
            raise ValueError(f"{self.folder} cannot be written: {error.strerror}") from None


def check_fits(name: str, whole: Area, on: str) -> None:
    """Raises UnplacedError where a netlist takes more of a part, by its name, than FULL."""
    has, takes = asdict(part(on).has), asdict(whole)
    for what in ("lut", "ff"):
        if takes[what] > FULL * has[what]:
            raise UnplacedError(
                f"{name} must take at most {FULL:.0%} of the {has[what]} {what.upper()} "
                f"of {on}, not {takes[what]} ({takes[what] / has[what]:.0%})"
            )


def taken(statistics: Path, of: Part) -> dict[str, Area]:
    """What each module of a netlist takes, of a file of Yosys's `stat -json`. Raises ValueError."""
    return {name: _area(found, of) for name, found in cells(_read(statistics)).items()}


def cells(statistics: Mapping[str, Any]) -> dict[str, Counter[str]]:
    """How many cells of each type each module has, of what Yosys's `stat -json` told."""
    modules = {name.removeprefix("\\"): told for name, told in statistics["modules"].items()}
    return {
        name: Counter(
            {
                cell: count
                for cell, count in told["num_cells_by_type"].items()
                if cell not in modules and cell != "$scopeinfo"
            }
        )
        for name, told in modules.items()
    }


def fmax_mhz(report: Mapping[str, Any]) -> float:
    """The clock in nextpnr's report. Raises ValueError unless there is just one."""
    clocks = report["fmax"]
    if len(clocks) != 1:
        raise ValueError(f"a report must tell of one clock, not of {len(clocks)}")
    return float(next(iter(clocks.values()))["achieved"])


def _area(found: Mapping[str, int], of: Part) -> Area:
    if odd := set(found) - set(of.takes):
        raise ValueError(f"a cell must be one of {', '.join(of.takes)}, not {', '.join(odd)}")
    return sum((of.takes[cell] * count for cell, count in found.items()), Area())


def _read(path: Path) -> Any:
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ValueError(f"{path} must be what a tool has written; remove its folder") from error
