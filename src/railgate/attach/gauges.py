"""Live values of each function, as plain numbers, strings and lists; see docs/commands.md.

A gauge only looks: it clears nothing, tests nothing. An odometer's read is its gate all the same:
whoever else reads that odometer loses the pulses of its interval, but not the cumulative counts.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, Protocol

from railgate.odometer.device import OdometerDevice
from railgate.odometer.host import (
    Estimate,
    Snapshot,
    Train,
    Verdict,
    Wheel,
    WheelRecord,
    direction,
    distance_m,
)
from railgate.odometer.spec import Direction, Flag
from railgate.position_link.device import LinkDevice
from railgate.registers.host import Bus, Registers
from railgate.unit.config import Unit
from railgate.vital_output.device import ChannelDevice

__all__ = ["GAUGES", "Gauge"]


TRAIN = (
    *("speed_kmh", "speed_low_kmh", "speed_high_kmh"),
    *("distance_m", "distance_low_m", "distance_high_m", "standstill"),
)
CHANNEL = (
    *("index", "sequence", "life", "image", "acknowledge", "blocked"),
    *("trusted", "linked", "drifting", "latched"),
)
VOTES = ("accepted", "start", "lost", "passed", "stored")


class Gauge(Protocol):
    """One function on a bus."""

    registers: Registers

    def __init__(self, bus: Bus, unit: Unit, base: int) -> None: ...

    def read(self) -> dict[str, Any]:
        """Its values now. Raises BusError, and ValueError where they have no meaning."""


class OdometerGauge:
    """Speed, direction and distance of the train and of each axle."""

    def __init__(self, bus: Bus, unit: Unit, base: int) -> None:
        self._device = OdometerDevice(bus, unit.odometer, base)
        self.registers = self._device.registers
        self._train = Train(unit.odometer, unit.assumptions, unit.wheels, unit.rolling)
        self._wheels = [_wheel(unit, record) for record in unit.wheels]
        self._before: tuple[Snapshot, ...] | None = None

    def read(self) -> dict[str, Any]:
        """See Gauge; distances are from the first reading on."""
        shots = self._device.snapshots()
        train = self._train.update(shots)
        axles = [self._axle(n, shot) for n, shot in enumerate(shots)]
        self._before = shots
        for axle, verdict in zip(axles, train.verdicts, strict=True):
            axle["verdict"] = Verdict(verdict).name.lower()
        return {
            "number": shots[0].number,
            "time_s": shots[0].time / self._device.config.clock_hz,
            "train": {name: _finite(getattr(train, name)) for name in TRAIN},
            "axles": axles,
        }

    def _axle(self, n: int, shot: Snapshot) -> dict[str, Any]:
        config = self._device.config
        estimate: Estimate = self._wheels[n].update(shot)
        way = Direction(shot.direction)
        if self._before is not None:
            way = direction(self._before[n], shot, config)
        return {
            "speed_kmh": estimate.value_kmh,
            "speed_low_kmh": estimate.low_kmh,
            "speed_high_kmh": _finite(estimate.high_kmh),
            "direction": way.name.lower(),
            "pulses": shot.pulses,
            "position_m": distance_m(shot.position, config),
            "flags": [str(flag.name).lower() for flag in Flag if flag in shot.causes],
        }


class LinkGauge:
    """The last delivery, and the causes since they were cleared."""

    def __init__(self, bus: Bus, unit: Unit, base: int) -> None:
        self._device = LinkDevice(bus, unit.link, base, unit.layout)
        self.registers = self._device.registers

    def read(self) -> dict[str, Any]:
        """See Gauge."""
        told = self._device.delivery()
        seen = self._device.seen()
        if told is None:
            return {"number": 0, "seen": [*seen]}
        return {
            "number": told.number,
            "word": f"{told.word:#x}",
            "status": told.status.name.lower(),
            "health": told.health.name.lower(),
            "age": told.age,
            "age_s": told.age_s,
            "values": dict(told.values),
            "causes": [*told.causes],
            "consistent": told.consistent,
            "seen": [*seen],
        }


class ChannelGauge:
    """States, votes and causes of one channel of the vital output."""

    def __init__(self, bus: Bus, unit: Unit, base: int) -> None:
        self._device = ChannelDevice(bus, unit.vital, base)
        self.registers = self._device.registers

    def read(self) -> dict[str, Any]:
        """See Gauge; of `causes` those that have been counted."""
        told = self._device.status()
        causes = {cause.name.lower(): count for cause, count in told.causes.items() if count}
        return {
            **{name: getattr(told, name) for name in CHANNEL},
            "states": [state.name.lower() for state in told.states],
            "test_phase": told.test_phase.name.lower(),
            "first_cause": told.first_cause.name.lower(),
            "first_output": told.first_output,
            **{name: getattr(told, name) for name in VOTES},
            "causes": causes,
            "seen": [cause.name.lower() for cause in self._device.seen()],
        }


GAUGES: dict[str, type[Gauge]] = {
    "ODO": OdometerGauge,
    "LNK": LinkGauge,
    "DRV": ChannelGauge,
}
"""By the three letters of a block's identity."""


def _wheel(unit: Unit, record: WheelRecord) -> Wheel:
    """The wheel, whose diameter is what the record has, within its tolerance."""
    nominal = float(unit.odometer.wheel_diameter_m)
    off = max(record.greatest_m - nominal, nominal - record.least_m)
    return Wheel(unit.odometer, replace(unit.assumptions, diameter_tolerance_m=off))


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
