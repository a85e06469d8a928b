"""The configuration of one on-board unit: of its three functions, and what its host assumes."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from fractions import Fraction

from railgate.odometer.host import Rolling, WheelRecord
from railgate.odometer.spec import Assumptions
from railgate.odometer.spec import Config as OdometerConfig
from railgate.position_link.host import Layout, example
from railgate.position_link.spec import Config as LinkConfig
from railgate.vital_output.spec import Config as VitalConfig

__all__ = ["AXLES", "UNITS", "Unit", "unit_named"]

AXLES = 2
"""Sensors of an odometer: standstill of the train takes both (ODO-11)."""
TOLERANCE = 0.001
"""Of a wheel's diameter, as a part of it."""
SIDES = 2
CREEP = 0.002
DAY = "2026-11-25"


def _wheels(config: OdometerConfig) -> tuple[WheelRecord, ...]:
    diameter_m = float(config.wheel_diameter_m)
    return tuple(
        WheelRecord(
            axle=f"axle {axle + 1}",
            diameter_m=diameter_m,
            least_m=diameter_m * (1 - TOLERANCE),
            greatest_m=diameter_m * (1 + TOLERANCE),
            day=DAY,
        )
        for axle in range(AXLES)
    )


@dataclass(frozen=True, kw_only=True)
class Unit:
    """What FPGA 1 and FPGA 2 are built for, and what the CPUs know. Raises ValueError.

    odometer: one on each FPGA, both on the same two sensors. link: on FPGA 1. layout: of its words.
    vital: of both channels; output 0 releases the doors on the left, output 1 those on the right.
    assumptions, rolling: what the intervals of speed and way rest on.
    """

    odometer: OdometerConfig = field(default_factory=OdometerConfig)
    layout: Layout = field(default_factory=example)
    vital: VitalConfig = field(default_factory=lambda: VitalConfig(outputs=2))
    assumptions: Assumptions = field(
        default_factory=lambda: Assumptions(tooth_error=0.03, late_ticks=20)
    )
    rolling: Rolling = field(default_factory=lambda: Rolling(creep=CREEP))

    def __post_init__(self) -> None:
        if self.odometer.sensors != AXLES:
            raise ValueError(f"sensors must be {AXLES}, not {self.odometer.sensors}")
        if self.vital.outputs != SIDES:
            raise ValueError(f"outputs must be 2, left and right, not {self.vital.outputs}")

    @property
    def link(self) -> LinkConfig:
        """For words of the layout."""
        return self.layout.config

    @property
    def wheels(self) -> tuple[WheelRecord, ...]:
        """The record of each axle's wheels."""
        return _wheels(self.odometer)


SLOT_PITCH_M = Fraction(86, 1000)
"""Of the long stator along a maglev line, whose slots its sensors count as others count teeth."""
SLOTS = 100


def _maglev() -> Unit:
    way = SLOTS * SLOT_PITCH_M / Fraction(math.pi)
    slots = OdometerConfig(
        wheel_diameter_m=way.limit_denominator(10**6),
        pulses_per_rev=SLOTS,
        overspeed_kmh=Fraction(550),
        minimum_kmh=Fraction(10),
    )
    return Unit(odometer=slots, rolling=Rolling())  # nothing rolls, so nothing creeps


UNITS = {"metro": Unit, "maglev": _maglev}
"""Those that a scenario can name: wheels of 650 mm with 200 teeth, or slots of a long stator."""


def unit_named(name: str) -> Unit:
    """One of UNITS. Raises ValueError."""
    if name not in UNITS:
        raise ValueError(f'unit must be one of {", ".join(UNITS)}, not "{name}"')
    return UNITS[name]()
