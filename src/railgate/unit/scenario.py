"""A run of the on-board unit: the train, its line, what is fitted, what goes wrong."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from math import floor

from railgate.bounds import require
from railgate.odometer.plant import Profile, Sensor
from railgate.unit.application import Rule
from railgate.unit.config import Unit, unit_named
from railgate.unit.faults import Fault
from railgate.unit.route import Route
from railgate.vital_output.plant import RelayTimes

__all__ = ["Scenario"]

MOST_S = 7_200
"""Of a run: its signals are kept in memory."""


@dataclass(frozen=True, kw_only=True)
class Scenario:
    """Everything outside the unit, and what it is built for. Raises ValueError.

    name: one that a person reads. unit: of UNITS. route: of the train. sensor: at each axle. rule:
    of the CPUs' application. relay: of each output. ppm_1, ppm_2: of the clocks of FPGA 1 and FPGA
    2. skew_s: by so much CPU 2's frames come later. faults: in any order.
    acknowledged_s: when the driver acknowledges alarms of the outputs. seed: of all that is random.
    """

    name: str
    route: Route
    unit: str = "metro"
    sensor: Sensor = field(default_factory=Sensor)
    rule: Rule = field(default_factory=Rule)
    relay: RelayTimes = field(default_factory=RelayTimes)
    ppm_1: Fraction = Fraction(0)
    ppm_2: Fraction = Fraction(0)
    skew_s: Fraction = Fraction(0)
    faults: tuple[Fault, ...] = ()
    acknowledged_s: tuple[Fraction, ...] = ()
    seed: int = 0

    def __post_init__(self) -> None:
        unit_named(self.unit)
        require(self, ("ppm_1", -2_000, 2_000), ("ppm_2", -2_000, 2_000), ("seed", 0, 2**31))
        if self.seconds > MOST_S:
            raise ValueError(f"a run must last at most {MOST_S} s, not {float(self.seconds):g} s")
        for fault in self.faults:
            if fault.start_s >= self.seconds:
                raise ValueError(
                    f"{fault.kind} must begin before the run's end at {float(self.seconds):g} s, "
                    f"not at {float(fault.start_s):g} s"
                )

    @property
    def config(self) -> Unit:
        """What the unit is built for."""
        return unit_named(self.unit)

    @property
    def profile(self) -> Profile:
        """The train's speed."""
        return self.route.profile()

    @property
    def cycles(self) -> int:
        """Whole system cycles of the run."""
        return floor(Fraction(self.route.calls[-1].departs_s) / self.config.vital.cycle_s)

    @property
    def seconds(self) -> Fraction:
        """What these cycles last."""
        return self.cycles * self.config.vital.cycle_s
