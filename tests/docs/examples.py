"""The examples of the pages: Python as it stands, commands with what they print."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from doctest import ELLIPSIS, NORMALIZE_WHITESPACE, OutputChecker
from pathlib import Path

from sybil import Document, Example, Sybil
from sybil.parsers.myst import CodeBlockParser, PythonCodeBlockParser

__all__ = ["DOCS", "document", "is_slow", "outside"]

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
SLOW = re.compile(r"% slow\n+\Z")
"""Before an example that takes long."""
COMMAND = re.compile(r"^\$ (?P<typed>.*\n(?:> ?.*\n)*)(?P<printed>(?:(?!\$ ).*\n)*)", re.M)
"""What is typed after `$`, on with `>`, and what is printed."""
ENDED = re.compile(r"\[exit code (\d+)\]\n\Z")
WIDTH = "110"
"""Columns that commands print."""
MOST_S = 900
"""That a command may take."""
COMPARED = ELLIPSIS | NORMALIZE_WHITESPACE


def document(path: Path) -> Document:
    """A page with its examples."""
    parsers = (PythonCodeBlockParser(doctest_optionflags=ELLIPSIS), CodeBlockParser("console", run))
    return Sybil(parsers, path=str(DOCS)).parse(path)


def is_slow(example: Example) -> bool:
    """It stands below a line `% slow`."""
    start = example.document.text.rfind("\n```", 0, example.region.start + 4) + 1
    return SLOW.search(example.document.text, 0, start) is not None


def run(example: Example) -> str | None:
    """What is wrong with a block of commands, nothing if they print what the page says."""
    block = example.parsed.rstrip("\n") + "\n"
    found = list(COMMAND.finditer(block))
    if "".join(match[0] for match in found) != block:
        return f"a block must begin with $, not {block.splitlines()[0]!r}"
    return next(filter(None, map(_failure, found)), None)


def _failure(match: re.Match[str]) -> str | None:
    typed = re.sub(r"^> ?", "", match["typed"], flags=re.M)
    wanted = match["printed"]
    ends = ENDED.search(wanted)
    code, printed = outside(typed)
    if code != (int(ends[1]) if ends else 0):
        return f"$ {typed}exit code {code}, printed:\n{printed}"
    wanted = ENDED.sub("", wanted)
    if not OutputChecker().check_output(wanted, printed, COMPARED):
        return f"$ {typed}must print\n{wanted}not\n{printed}"
    return None


def outside(typed: str) -> tuple[int, str]:
    """Exit code and output of a command line in the shell, railgate's commands before others."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    done = subprocess.run(
        ["bash", "-c", typed],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env={**os.environ, "PATH": path, "COLUMNS": WIDTH},
        check=False,
        timeout=MOST_S,
    )
    return done.returncode, done.stdout
