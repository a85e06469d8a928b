"""The matrix as files."""

from __future__ import annotations

import json
from datetime import UTC, datetime
from functools import partial
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined

from railgate.evidence.matrix import KINDS, Matrix, Status
from railgate.evidence.table import age, count
from railgate.records import write_folder
from railgate.waves import replacing

__all__ = ["record"]

COLOURS = {"passed": "green", "failed": "red", "cited": "grey"}
"""Of a result; of all others amber."""


def record(matrix: Matrix, folder: Path) -> list[Path]:
    """Write matrix.html, a page by itself, and matrix.json into `folder`; returns their paths.

    Raises ValueError.
    """
    told = json.dumps(matrix.as_json(), ensure_ascii=False, indent=1) + "\n"
    texts = {"matrix.html": _page(matrix), "matrix.json": told}
    return write_folder(folder, {name: partial(_write, text) for name, text in texts.items()})


def _write(text: str, path: Path) -> None:
    with replacing(path) as new:
        new.write_text(text, encoding="utf-8")


def _page(matrix: Matrix) -> str:
    made = Environment(
        loader=PackageLoader("railgate.evidence", "."),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return made.get_template("page.html").render(
        matrix=matrix,
        kinds=KINDS,
        statuses=list(Status),
        colours=COLOURS,
        count=count,
        age=age,
        made=datetime.fromtimestamp(matrix.at, UTC).strftime("%Y-%m-%d %H:%M UTC"),
    )
