"""What a function takes of an FPGA, as `railgate fpga report` has measured it.

`fpga.json` here is a copy of what it wrote to `build/`.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from railgate.fpga.targets import TARGETS
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
    "lut_ratio": "LUT, of naive",
    "goal_mhz": "goal, MHz",
}
"""What is told of a row, and as what."""

RECORD = Path(__file__).with_name("fpga.json")
"""An array of objects; those of a function have its name as `target`."""


def resources(name: str) -> str:
    """A table of what a function came to, and whether it has changed since. Raises ValueError."""
    function(name)
    told: list[dict[str, Any]] = json.loads(RECORD.read_text("utf-8"))
    measured = [each for each in told if each["target"] == name]
    if not measured:
        return "Not measured yet.\n"
    rows = [
        ["" if each[key] is None else number(each[key]) for key in COLUMNS] for each in measured
    ]
    made = table(list(COLUMNS.values()), rows)
    if {each["digest"] for each in measured} != {TARGETS[name].sources().digest}:
        made += "\nThe gateware has changed since: measure it anew with `railgate fpga report`.\n"
    return made
