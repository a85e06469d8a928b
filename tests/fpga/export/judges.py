"""Exported cores before the tools of those who take them."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

import pytest

from verilated import environment

__all__ = ["Core", "icarus", "needs_icarus", "run", "verilator"]

needs_icarus = pytest.mark.skipif(
    shutil.which("iverilog") is None,
    reason="iverilog is missing (Debian: apt-get install iverilog)",
)

Result = subprocess.CompletedProcess[str]


class Core:
    """One that was exported as `core`."""

    def __init__(self, folder: Path) -> None:
        (self.path,) = folder.glob("*.core")
        self.name = self.path.stem

    def file(self, suffix: str) -> Path:
        """`.v`, `_tb.sv`, …"""
        return self.path.with_name(f"{self.name}{suffix}")

    def text(self, suffix: str) -> str:
        return self.file(suffix).read_text(encoding="utf-8")

    @property
    def verilog(self) -> list[Path]:
        return [self.file(".vlt"), self.file(".v")]


def run(command: Sequence[str | Path], folder: Path) -> Result:
    """With Verilator in reach."""
    return subprocess.run(
        [str(part) for part in command],
        cwd=folder,
        env=os.environ | environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )


def icarus(core: Core, scratch: Path, ticks: int | None = None, verilog: str = "") -> Result:
    """Its test bench; with another Verilog in the place of its own if there is one."""
    source = core.file(".v")
    if verilog:
        source = scratch / "other.v"
        source.write_text(verilog, encoding="utf-8")
    made = run(["iverilog", "-g2012", "-o", "bench.vvp", source, core.file("_tb.sv")], scratch)
    assert made.returncode == 0, made.stdout
    told = [f"+vectors={core.file('.vectors')}"] + ([f"+ticks={ticks}"] if ticks else [])
    return run(["vvp", "-n", "bench.vvp", *told], scratch)


def verilator(core: Core, scratch: Path, other: Sequence[str] = ()) -> Result:
    """Its test bench, whole; with other options and sources in the place of its own if there are
    some."""
    options = [
        "--binary",
        "--timing",
        "-j",
        "1",
        "--Mdir",
        "made",
        "--top-module",
        f"{core.name}_tb",
    ]
    made = run(["verilator", *options, *(other or core.verilog), core.file("_tb.sv")], scratch)
    assert made.returncode == 0, made.stdout
    told = f"+vectors={core.file('.vectors')}"
    return run([scratch / "made" / f"V{core.name}_tb", told], scratch)
