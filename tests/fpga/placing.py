"""What the report places, on the part that goals are set for."""

from __future__ import annotations

from pathlib import Path

from railgate.fpga.flow import Flow
from railgate.fpga.parts import REFERENCE
from railgate.fpga.targets import TARGETS

__all__ = ["flow"]

KEPT = Path(__file__).parents[2] / "build" / "fpga"
"""Of the checkout: what `railgate fpga report` has placed there is not placed again."""

LIMIT_S = 3600.0


def flow(name: str) -> Flow:
    return Flow(name, TARGETS[name].sources(), REFERENCE, KEPT, LIMIT_S)
