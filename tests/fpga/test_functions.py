"""Every function is placed and routed for a real part."""

from pathlib import Path

import pytest

from railgate.fpga.flow import Flow
from railgate.fpga.gateware import netlist
from railgate.fpga.parts import REFERENCE
from railgate.fpga.targets import CEILING, TARGETS

KEPT = Path(__file__).parents[2] / "build" / "fpga"
"""Of the checkout: what `railgate fpga report` has placed there is not placed again."""

LIMIT_S = 3600.0

FUNCTIONS = [name for name, target in TARGETS.items() if target.kind == "function"]


def flow(name: str) -> Flow:
    return Flow(name, netlist(TARGETS[name].component()), REFERENCE, KEPT, LIMIT_S)


@pytest.mark.slow
@pytest.mark.shows("SYS-3", kind="sweep")
@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_has_its_clock_and_area_on_a_real_part(name) -> None:
    made = flow(name)
    taken = made.synthesise().inside
    assert taken.lut > 100
    assert taken.ff > 100
    assert 16 < made.place(1) < flow(CEILING).place(1)  # its reference clock, and the ceiling
