"""From RTLIL to Verilog, and to what the borders are found in."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from railgate.fpga.tools import yosys

__all__ = ["Translated", "translate"]

LIMIT_S = 600.0
REMOVED = "generator top amaranth.hierarchy amaranth.decoding"
"""Attributes that tell of the way here."""

# Multiplexers as trees: of wider ones Yosys makes functions that Icarus Verilog fails of.
SCRIPT = f"""
read_rtlil design.il
attrmap {" ".join(f"-remove {name}" for name in REMOVED.split())}
attrmap -modattr {" ".join(f"-remove {name}" for name in REMOVED.split())}
proc
pmuxtree
opt_clean -purge
memory_collect
write_verilog design.v
hierarchy -top {{top}}
flatten
memory
opt_clean
write_json flat.json
"""


@dataclass(frozen=True)
class Translated:
    """verilog: a module for each of RTLIL's. flat: the same as one, as Yosys's write_json tells
    it, of registers and combinational cells."""

    verilog: str
    flat: Any


def translate(rtlil: str, top: str) -> Translated:
    """top: its name. Raises ValueError where Yosys is missing or fails."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "design.il").write_text(rtlil, encoding="utf-8")
        yosys(SCRIPT.format(top=top), folder, LIMIT_S)
        text = (folder / "design.v").read_text(encoding="utf-8")
        flat = json.loads((folder / "flat.json").read_text(encoding="utf-8"))
    _, _, verilog = text.partition("*/\n")  # who has made it is told in the header
    return Translated(verilog.lstrip("\n"), flat)
