"""A position system for the link: answers, and a cycle without one."""

from __future__ import annotations

from railgate.position_link.plant import Fault, Scenario
from railgate.position_link.spec import Config
from railgate.waves import Trace

__all__ = ["link"]

CYCLES = 4


def link(config: Config) -> Trace:
    """The link's inputs: two answers, none, and one again."""
    missed = Fault(kind="missing", start_s=2 * config.cycle_s)
    return Scenario(faults=(missed,)).plan(config, CYCLES).drive()
