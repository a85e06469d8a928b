"""Runs of the built-in situations in the scaled configuration."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import cache

from railgate.vital_output.plant.relay import RelayTimes
from railgate.vital_output.plant.scenario import Scenario
from railgate.vital_output.simulate import Run, simulate
from railgate.vital_output.situations import SITUATIONS
from vital_output.small import SMALL

__all__ = ["RELAY", "run_of", "scenario_of"]

RELAY = RelayTimes(pick_up_s=Fraction(8, 10_000), release_s=Fraction(7, 1000))


def scenario_of(situation: str) -> Scenario:
    """With clocks that part as far as they may, where the situation has none of its own."""
    scenario = SITUATIONS[situation].make(SMALL)
    ppm_1 = scenario.ppm_1 or Fraction(100)
    return replace(scenario, relay=RELAY, ppm_1=ppm_1, ppm_2=Fraction(-100))


@cache
def run_of(situation: str) -> Run:
    """As the model has it."""
    return simulate(scenario_of(situation), SMALL)
