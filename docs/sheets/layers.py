"""What may import what: import-linter's contracts, as a diagram and as a list."""

from __future__ import annotations

import tomllib
from functools import cache
from html import escape
from pathlib import Path
from typing import Any

from sheets.markdown import html, table

__all__ = ["contracts", "layers"]

PYPROJECT = Path(__file__).parents[2] / "pyproject.toml"


@cache
def _contracts() -> list[dict[str, Any]]:
    found = tomllib.loads(PYPROJECT.read_text("utf-8"))["tool"]["importlinter"]["contracts"]
    return list(found)


def layers(name: str) -> str:
    """A diagram of the contract of that name: boxes over those that they may import.

    Raises ValueError where there is none.
    """
    for each in _contracts():
        if each["type"] == "layers" and each["name"] == name:
            return html(_diagram(each["layers"], name))
    raise ValueError(f'no contract of layers is called "{name}" in pyproject.toml')


def _diagram(rows: list[str], name: str) -> str:
    lines = [f'<div class="layers" role="img" aria-label="{escape(name)}">']
    for row in rows:
        boxes = (_short(each) for each in row.replace(":", "|").split("|"))
        spans = "".join(f"<span>{escape(each)}</span>" for each in boxes)
        lines.append(f"<div>{spans}</div>")
    return "\n".join([*lines, "</div>"])


def _short(module: str) -> str:
    return module.strip().strip("()").removeprefix("railgate.")


def contracts(_: str) -> str:
    """A table of the contracts that are none of layers."""
    rows = [
        (each["name"], each["type"], ", ".join(f"`{_short(m)}`" for m in _modules(each)))
        for each in _contracts()
        if each["type"] != "layers"
    ]
    return table(("contract", "kind", "of"), rows)


def _modules(contract: dict[str, Any]) -> list[str]:
    return list(contract.get("modules") or contract.get("source_modules") or [])
