"""Every function is placed and routed for a real part."""

import pytest

from fpga.placing import flow
from railgate.fpga.targets import CEILING, TARGETS

FUNCTIONS = [name for name, target in TARGETS.items() if target.kind == "function"]


@pytest.mark.slow
@pytest.mark.shows("SYS-3", kind="sweep")
@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_has_its_clock_and_area_on_a_real_part(name) -> None:
    made = flow(name)
    taken = made.synthesise().inside
    assert taken.lut > 100
    assert taken.ff > 100
    assert 16 < made.place(1) < flow(CEILING).place(1)  # its reference clock, and the ceiling
