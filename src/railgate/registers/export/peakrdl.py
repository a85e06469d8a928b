"""C header and HTML pages, made by the command `peakrdl` from the map's SystemRDL.

PeakRDL is called, never imported: it is a tool, under a licence of its own.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

from railgate.registers.export.systemrdl import systemrdl
from railgate.registers.map import Map

__all__ = ["c_header", "html"]

HEADER_OPTIONS = ("--std", "gnu11")
"""Packed structures, static_assert."""


def c_header(map_: Map, path: Path) -> None:
    """Write a header: a structure of the map, and of each field mask, position, width and start
    value. Raises ValueError where PeakRDL is missing or the file cannot be written."""
    _peakrdl("c-header", "peakrdl_cheader", map_, path, HEADER_OPTIONS)


def html(map_: Map, folder: Path) -> None:
    """Write pages to be searched and linked to; index.html is the first one. Raises ValueError, as
    c_header does."""
    _peakrdl("html", "peakrdl_html", map_, folder, ("--title", map_.description))


def _peakrdl(command: str, package: str, map_: Map, out: Path, options: Sequence[str]) -> None:
    for needed in ("peakrdl", package):
        if find_spec(needed) is None:
            raise ValueError(
                f"{command} needs PeakRDL; install it with: pip install 'railgate[registers]'"
            )
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ValueError(f"{out} cannot be written: {error.strerror}") from None
    with TemporaryDirectory() as folder:
        source = Path(folder) / f"{map_.name}.rdl"
        source.write_text(systemrdl(map_), encoding="utf-8")
        done = subprocess.run(
            [
                sys.executable,
                "-X",
                "utf8",
                "-m",
                "peakrdl",
                command,
                str(source),
                "-o",
                str(out),
                *options,
            ],
            capture_output=True,
            text=True,
            check=False,
        )
    if done.returncode:
        last = done.stderr.strip().splitlines()[-1:] or ["no reason told"]
        raise ValueError(f"peakrdl {command} failed: {last[0]}")
