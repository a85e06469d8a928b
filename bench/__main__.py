"""Run all benches: a table, and build/bench.json. Or only those named: the table."""

from __future__ import annotations

import importlib
import json
import sys
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

BENCHES = ("leap", "link", "vital", "unit", "simulators", "estimators", "slip", "readers")
RESULT = Path("build/bench.json")


def main(names: list[str]) -> int:
    if unknown := set(names) - set(BENCHES):
        print(f"a bench must be one of {', '.join(BENCHES)}, not {', '.join(sorted(unknown))}")
        return 2
    console = Console()
    rows: list[dict[str, Any]] = []
    for name in names or BENCHES:
        console.print(f"[bold]{name}[/bold] …")
        rows += importlib.import_module(f"bench.{name}").run()
        if not names:
            RESULT.parent.mkdir(exist_ok=True)
            RESULT.write_text(json.dumps(rows, indent=1) + "\n")  # what is done is kept
    table = Table("figure", "value", "unit", "goal", "met")
    for row in rows:
        met = {True: "[green]yes", False: "[red]no", None: ""}[row["met"]]
        goal = f"{row['sense']} {_text(row['goal'])}" if row["sense"] else ""
        table.add_row(row["name"], _text(row["value"]), row["unit"], goal, met)
    console.print(table)
    if not names:
        console.print(f"wrote {RESULT}")
    return 0 if all(row["met"] is not False for row in rows) else 1


def _text(value: object) -> str:
    return f"{value:.5g}" if isinstance(value, float) else str(value)


sys.exit(main(sys.argv[1:]))
