"""A short run that tests look at: from one platform to the next, the doors on the right."""

from railgate.unit.route import Route, Side, Stop
from railgate.unit.scenario import Scenario

SHORT = Scenario(
    name="short",
    route=Route(
        stops=(
            Stop(at_m=0, side=Side.RIGHT, dwell_s=10),
            Stop(at_m=60, side=Side.LEFT, dwell_s=5),
        ),
        speed_kmh=40,
    ),
)
OPEN_S, RUNS_S = 5, 17
"""When the doors are released, and when the train is between the platforms."""

FILE = """
name = "short"
[train]
speed_kmh = 40
[[stop]]
at_m = 0
side = "right"
dwell_s = 10
[[stop]]
at_m = 60
side = "left"
dwell_s = 5
"""
"""The same as a file."""
