"""What the guaranteed intervals of a run rest on, and what of it the scenario does not keep."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from math import inf

from railgate.unit.faults import Fault
from railgate.unit.scenario import Scenario

__all__ = ["broken", "clocks_off"]

ROLLING = ("locked", "slide", "slip")


def clocks_off(scenario: Scenario) -> Iterator[tuple[int, float]]:
    """Each FPGA whose clock is further off than the unit is built for, and by how many ppm."""
    tolerated = scenario.config.vital.tolerance_ppm
    for fpga, ppm in enumerate((scenario.ppm_1, scenario.ppm_2), 1):
        if abs(ppm) > tolerated:
            yield fpga, float(ppm)


def broken(scenario: Scenario) -> tuple[str, ...]:
    """The premises of the speed's and the distance's interval that do not hold throughout, a
    sentence each."""
    return (*_clock(scenario), *_sensors(scenario), *_motion(scenario), *_wheels(scenario))


def _clock(scenario: Scenario) -> Iterator[str]:
    assumed = scenario.config.assumptions.crystal_ppm
    for fpga, ppm in enumerate((scenario.ppm_1, scenario.ppm_2), 1):
        if abs(ppm) > assumed:
            yield f"clock within ±{assumed:g} ppm: FPGA {fpga}'s is {float(ppm):+g} ppm off"


def _sensors(scenario: Scenario) -> Iterator[str]:
    sensor, assumed = scenario.sensor, scenario.config.assumptions
    late = sensor.jitter_s * scenario.config.odometer.clock_hz + 1
    if sensor.tooth_error > assumed.tooth_error:
        yield (
            f"edges within ±{assumed.tooth_error:g} pitch of their places: "
            f"they are up to {sensor.tooth_error:g} off"
        )
    if late > assumed.late_ticks:
        yield f"edges stamped less than {assumed.late_ticks:g} ticks late: they are up to {late:g}"
    if sensor.dropouts or sensor.glitches_hz:
        yield "no edge lost or false: the sensors lose pulses or add some"


def _motion(scenario: Scenario) -> Iterator[str]:
    assumed, real = scenario.config.assumptions, scenario.profile.acceleration_m_s2
    if real > assumed.acceleration_max:
        yield (
            f"the train's acceleration within ±{assumed.acceleration_max:g} m/s²: "
            f"it reaches {real:g} m/s²"
        )


def _wheels(scenario: Scenario) -> Iterator[str]:
    """An axle that slips, slides or is locked breaks none of them as long as another one rolls."""
    off = [fault for fault in scenario.faults if fault.part == "wheel"]
    for fault in off:
        if fault.kind not in ROLLING:
            yield (
                f"no edge lost or false: axle {fault.axle}, {fault.kind.replace('-', ' ')} "
                f"from {float(fault.start_s):g} s on"
            )
    for one, other in combinations(off, 2):
        start = max(one.start_s, other.start_s)
        if one.axle != other.axle and start < min(_back(scenario, one), _back(scenario, other)):
            yield f"an axle that rolls and is measured: from {float(start):g} s on there is none"


def _back(scenario: Scenario, fault: Fault) -> float:
    """When the axle can be believed again."""
    return inf if fault.end_s is None else float(fault.end_s) + scenario.config.rolling.rejoin_s
