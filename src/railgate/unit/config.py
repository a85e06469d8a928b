"""The configuration of one on-board unit: of its three functions, and what its host assumes."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from fractions import Fraction

from railgate.odometer.spec import Assumptions
from railgate.odometer.spec import Config as OdometerConfig
from railgate.position_link.host import Layout, example
from railgate.position_link.spec import Config as LinkConfig
from railgate.vital_output.spec import Config as VitalConfig

__all__ = ["AXLES", "UNITS", "Unit"]

AXLES = 2
"""Sensors of an odometer: standstill of the train takes both (ODO-11)."""

SLOT_PITCH_M = Fraction(86, 1000)
"""Of the long stator along a maglev line, whose slots its sensors count as others count teeth."""
SLOTS = 100


@dataclass(frozen=True, kw_only=True)
class Unit:
    """What FPGA 1 and FPGA 2 are built for. Raises ValueError.

    odometer: one on each FPGA, both on the same two sensors. link: on FPGA 1. layout: of its words.
    vital: of both channels. assumptions: what the speed's interval rests on.
    """

    odometer: OdometerConfig = field(default_factory=OdometerConfig)
    layout: Layout = field(default_factory=example)
    link: LinkConfig = field(default_factory=lambda: example().config)
    vital: VitalConfig = field(default_factory=lambda: VitalConfig(outputs=2))
    assumptions: Assumptions = field(default_factory=Assumptions)

    def __post_init__(self) -> None:
        if self.odometer.sensors != AXLES:
            raise ValueError(f"sensors must be {AXLES}, not {self.odometer.sensors}")
        if self.layout.applied_to(self.link) != self.link:
            raise ValueError("link must be for words of layout, not of another one")


def _maglev() -> Unit:
    slots = OdometerConfig(
        wheel_diameter_m=Fraction(SLOTS * SLOT_PITCH_M / Fraction(math.pi)).limit_denominator(
            10**6
        ),
        pulses_per_rev=SLOTS,
        overspeed_kmh=Fraction(550),
        minimum_kmh=Fraction(10),
    )
    return replace(Unit(), odometer=slots)


UNITS = {"metro": Unit, "maglev": _maglev}
"""Those that a scenario can name: wheels of 650 mm with 200 teeth, or slots of a long stator."""
