"""The evidence of a frame's CRC as files."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from railgate.records import Columns, tables, write_folder
from railgate.vital_output.residual.evidence import RATES, Comparison
from railgate.vital_output.residual.picture import draw

__all__ = ["record"]


def record(comparison: Comparison, folder: Path) -> list[Path]:
    """Write the curves and the picture into `folder`, see `write_folder`; returns their paths.

    Raises ValueError.
    """
    return write_folder(
        folder,
        {
            **tables("residual", _curves(comparison)),
            "residual.png": partial(draw, comparison),
        },
    )


def _curves(comparison: Comparison) -> Columns:
    """By the bit's error rate, a column for each curve of each polynomial."""
    columns: dict[str, list[float | None]] = {"error_rate": list(RATES)}
    for code in comparison.codes:
        told = code.as_json() | {"bound": [comparison.bound(code, rate) for rate in RATES]}
        name = told["polynomial"]
        columns[name] = told["probability"]
        columns |= {f"{name} {line['line']}": line["probability"] for line in told["lines"]}
        columns[f"{name} bound"] = told["bound"]
    return columns
