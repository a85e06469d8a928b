"""The sensing half of a run: what both odometers and the position link tell, cycle by cycle.

Nothing that the unit does changes the train's motion in a scenario, so each function runs through
the whole run by itself, one after the other.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railgate.engines import open_engine
from railgate.odometer.design import design as odometer_design
from railgate.odometer.host import Snapshot, snapshots
from railgate.odometer.host.membership import SEEN
from railgate.odometer.plant import Channel, Profile
from railgate.odometer.spec import Config
from railgate.position_link.design import design as link_design
from railgate.position_link.host import Deliveries, deliveries
from railgate.position_link.plant import Scenario as LinkScenario
from railgate.unit.config import AXLES
from railgate.unit.faults import link_faults, sensors, wheel
from railgate.unit.scenario import Scenario
from railgate.waves import Trace, Waveform

__all__ = ["Channels", "Link", "Odometer", "link", "odometer", "rate", "strobes", "wheels"]

Channels = Mapping[str, Channel]

LINK_LEAD = 1
"""Cycles of the link beyond the run's end, so that the last one is whole."""


@dataclass(frozen=True, eq=False)
class Odometer:
    """One FPGA's. stimulus: its pins and strobes, in ticks of its clock. outputs: its fields."""

    config: Config
    stimulus: Trace
    outputs: Trace

    @cached_property
    def shots(self) -> list[tuple[Snapshot, ...]]:
        """Of each strobe one snapshot of each axle."""
        axles = [snapshots(self.outputs, self.config, sensor) for sensor in range(AXLES)]
        return list(zip(*axles, strict=True))

    @cached_property
    def seen(self) -> NDArray[Any]:
        """Of each strobe what Train uses of the snapshots, shape (strobes, axles)."""
        there = self.outputs["number"].ticks[1:]
        found = np.empty((there.size, AXLES), SEEN)
        for name in found.dtype.names or ():
            for axle in range(AXLES):
                field = name if name == "time" else f"sensor.{axle}.{name}"
                found[name][:, axle] = self.outputs[field].at(there)
        return found


@dataclass(frozen=True)
class Link:
    """stimulus: its pins, in ticks of its clock. told: its deliveries. times_s: when each is
    there."""

    stimulus: Trace
    told: Deliveries
    times_s: NDArray[np.float64]


def rate(scenario: Scenario, fpga: int) -> Fraction:
    """Ticks of FPGA 1's or FPGA 2's clocks for one that was exact."""
    return 1 + (scenario.ppm_1, scenario.ppm_2)[fpga - 1] / 1_000_000


def wheels(scenario: Scenario, profile: Profile) -> Channels:
    """What every sensor's channels do, by the names of their pins."""
    config, found = scenario.config.odometer, dict[str, Channel]()
    for axle, sensor in enumerate(sensors(scenario.sensor, scenario.faults, scenario.seed)):
        turned = wheel(profile, axle + 1, scenario.faults)
        for name, channel in sensor.channels(turned, config).items():
            found[f"sensor.{axle}.{name}"] = channel
    return found


def strobes(scenario: Scenario, fpga: int) -> list[int]:
    """The tick of the FPGA's clock in which each system cycle's strobe comes, and the run's end.

    The first cycle has none: a run begins with it.
    """
    per_cycle = scenario.config.vital.cycle_s * scenario.config.odometer.clock_hz
    step = per_cycle * rate(scenario, fpga)
    up, down = step.numerator, step.denominator
    return [-(-n * up // down) for n in range(1, scenario.cycles + 1)]


def odometer(scenario: Scenario, fpga: int, channels: Channels, engine: str = "leap") -> Odometer:
    """Run FPGA 1's or FPGA 2's odometer; its clock is not quite exact."""
    config, hz = scenario.config.odometer, scenario.config.odometer.clock_hz
    *strobed, end = strobes(scenario, fpga)
    times = np.array(strobed, np.int64)
    ticks = np.append(0, np.column_stack([times, times + 1]))
    real_hz = float(hz * rate(scenario, fpga))
    signals = {name: channel.wave(real_hz, end) for name, channel in channels.items()}
    signals["strobe"] = Waveform.of(ticks, np.arange(ticks.size) & 1)
    stimulus = Trace(signals, Fraction(1, hz), 0, end)
    outputs = open_engine(odometer_design(config), engine).advance(end, stimulus)
    return Odometer(config, stimulus, outputs)


def link(scenario: Scenario, profile: Profile, engine: str = "leap") -> Link:
    """Run the position link of FPGA 1 against its position system."""
    unit = scenario.config
    config, real = unit.link, rate(scenario, 1)
    cycles = int(scenario.seconds / config.cycle_s * real) + LINK_LEAD
    asked_s = np.arange(cycles, dtype=np.float64) * float(config.cycle_s / real)
    words = unit.layout.words(
        {
            "position": scenario.route.start_m + profile.position_m(asked_s),
            "speed": np.abs(profile.speed_kmh(asked_s)),
            "sequence": np.arange(cycles) % 16,
        }
    )
    faults = link_faults(scenario.faults, real)
    outside = LinkScenario(words=words, faults=faults, seed=scenario.seed)
    stimulus = outside.plan(config, cycles).drive()
    names = ["delivery", *(field.name for field in config.fields)]
    outputs = open_engine(link_design(config), engine).advance(stimulus.end, stimulus, names)
    told = deliveries(outputs, config, unit.layout)
    return Link(stimulus, told, told.ticks / float(config.clock_hz * real))
