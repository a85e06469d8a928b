"""The odometer's registers (ODO-6, ODO-7, ODO-8).

The snapshot is one burst of a size that only the number of sensors changes: what all sensors
share, then each sensor's fields. Reading its first word is the gate. A write to `strobe` is the
gate too, as is the port of that name: after either, each of the units that were strobed together
gives its burst at its second place. While another strobe may come, `number` read again after the
burst tells whether it was whole.
"""

from __future__ import annotations

from dataclasses import replace

from railgate.odometer.spec import STAMP, Config, Direction, Field, Flag
from railgate.registers import Access, Block, Gate, Group, Register, Values, gather, identity

__all__ = ["registers"]

VERSION = 1

STATE = (
    "flags",
    "level_a",
    "level_b",
    "direction",
    "phase_direction",
    "period_valid",
    "window_seated",
)
VALUES: dict[str, Values] = {"flags": Flag, "direction": Direction, "phase_direction": Direction}


def registers(config: Config) -> Block:
    """What the bus sees of one odometer; fields of sensor n are called `sensor_<n>_<field>`."""
    sensors = range(config.sensors)
    snapshot = Group(
        name="snapshot",
        description="all sensors as of one strobe",
        registers=(
            *gather(config.common_fields, {}, {}),
            *(each for sensor in sensors for each in _sensor(config, sensor)),
        ),
        gate=Gate.STROBE,
    )
    strobe = Field("strobe", 1, "latches all sensors, without waiting for their fields")
    stamps = sensors if config.stamp_depth else ()
    return Block(
        name="odometer",
        description="period, phase, pulses and position of two-channel wheel sensors",
        entries=(
            *identity("ODO", VERSION, config.digest),
            Register(name="control", fields=(strobe,), access=Access.TRIGGER),
            snapshot,
            *(_stamps(sensor) for sensor in stamps),
        ),
    )


def _sensor(config: Config, sensor: int) -> tuple[Register, ...]:
    """One sensor's part of the burst."""
    prefix = f"sensor_{sensor}_"
    return gather(
        [replace(each, name=prefix + each.name) for each in config.sensor_fields],
        {f"{prefix}state": [prefix + name for name in STATE]},
        {prefix + name: values for name, values in VALUES.items()},
    )


def _stamps(sensor: int) -> Group:
    """The oldest stamp of one sensor, taken by its gate (ODO-13)."""
    prefix = f"sensor_{sensor}_stamps_"
    fields = (Field("valid", 1, "there was a stamp to take"), *STAMP)
    return Group(
        name=f"sensor_{sensor}_stamps",
        description="the oldest stamp that has not been taken",
        registers=gather(
            [replace(each, name=prefix + each.name) for each in fields],
            {f"{prefix}edge": [prefix + name for name in ("valid", "a", "b", "lost")]},
            {},
        ),
        gate=Gate.TAKE,
    )
