"""What every command says of itself with --help."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import redirect_stdout
from io import StringIO
from typing import Any

from typer.main import get_command

from railgate.cli import app
from sheets.markdown import code

__all__ = ["helps"]

COLUMNS = "100"


def helps(_: str) -> str:
    """A section for each command, in the order of --help."""
    return "\n".join(
        f"## railgate {' '.join(names)}\n\n{code(_help(names))}"
        for names in _commands(get_command(app), ())
    )


def _commands(command: object, names: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    """The names that lead to each command that does something."""
    inside: Mapping[str, Any] | None = getattr(command, "commands", None)
    if inside is not None:
        for name, inner in inside.items():
            yield from _commands(inner, (*names, name))
    else:
        yield names


def _help(names: tuple[str, ...]) -> str:
    printed = StringIO()
    before = os.environ.get("COLUMNS")
    os.environ["COLUMNS"] = COLUMNS  # the width that Rich takes where there is no terminal
    try:
        with redirect_stdout(printed):
            get_command(app).main([*names, "--help"], "railgate", standalone_mode=False)
    finally:
        if before is None:
            del os.environ["COLUMNS"]
        else:
            os.environ["COLUMNS"] = before
    return "\n".join(line.rstrip() for line in printed.getvalue().strip("\n").splitlines())
