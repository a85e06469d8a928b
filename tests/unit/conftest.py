"""One real run for all tests of what is told of it."""

import pytest

from railgate.unit.result import Result
from railgate.unit.run import run
from railgate.unit.scenario_file import parse_scenario

TEXT = """
name = "link, wheel and CPU <fail>"
seed = 9
ppm_1 = 100
ppm_2 = -100

[train]
speed_kmh = 45

[[stop]]
at_m = 50
side = "right"
dwell_s = 7

[[stop]]
at_m = 150
side = "left"
dwell_s = 10

[[fault]]
part = "link"
kind = "missing"
at_s = 9
lasts_s = 0.2

[[fault]]
part = "wheel"
kind = "locked"
axle = 2
at_s = 12
lasts_s = 4

[[fault]]
part = "vital"
kind = "cpu-1-dead"
at_s = 30
"""


@pytest.fixture(scope="session")
def result() -> Result:
    """Of a run of some thirty seconds in which a word is missing, a wheel locks and a CPU dies."""
    return Result("failing", TEXT, run(parse_scenario(TEXT, "failing.toml")))
