"""What a function takes of an FPGA, from the last build's record, where there is one."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from sheets.functions import function
from sheets.markdown import number, table

__all__ = ["RECORD", "resources"]

RECORD = Path(__file__).parents[2] / "build" / "fpga.json"
"""An array of objects; those of a function have its name as `target`."""


def resources(name: str) -> str:
    """A table of what the builds of a function came to. Raises ValueError."""
    function(name)
    if not RECORD.exists():
        return "Not measured yet: nothing has been placed and routed so far (SYS-3).\n"
    told: list[dict[str, Any]] = json.loads(RECORD.read_text("utf-8"))
    rows = [
        {k: v for k, v in each.items() if k != "target"} for each in told if each["target"] == name
    ]
    if not rows:
        return "Not among the builds that `build/fpga.json` tells of.\n"
    header = list(rows[0])
    return table(header, [[number(row.get(key, "")) for key in header] for row in rows])
