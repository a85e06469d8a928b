"""What a function takes of an FPGA, from the last build's record, where there is one."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from sheets.functions import function
from sheets.markdown import number, table

__all__ = ["RECORD", "resources"]

COLUMNS = {
    "part": "part",
    "fmax_worst_mhz": "worst, MHz",
    "fmax_median_mhz": "median, MHz",
    "seeds": "seeds",
    "lut": "LUT",
    "ff": "FF",
    "ram": "RAM",
    "dsp": "DSP",
    "goal_mhz": "goal, MHz",
}
"""What is told of a row, and as what."""

RECORD = Path(__file__).parents[2] / "build" / "fpga.json"
"""An array of objects; those of a function have its name as `target`."""


def resources(name: str) -> str:
    """A table of what the builds of a function came to. Raises ValueError."""
    function(name)
    if not RECORD.exists():
        return "Not measured yet: nothing has been placed and routed so far (SYS-3).\n"
    told: list[dict[str, Any]] = json.loads(RECORD.read_text("utf-8"))
    rows = [[number(each[key]) for key in COLUMNS] for each in told if each["target"] == name]
    if not rows:
        return "Not among the builds that `build/fpga.json` tells of.\n"
    return table(list(COLUMNS.values()), rows)
