"""What is outside the odometer's pins: a train's speed profile, its wheels, two-channel sensors.

Ref: source 000, sections 1.1, 1.2 and 2.1; ODO-1.
"""

from railgate.odometer.plant.adhesion import CONDITIONS, Journey, journey
from railgate.odometer.plant.profile import (
    PROFILES,
    Floats,
    Profile,
    constant,
    course,
    ramp,
    read_profile,
    run,
    shuttle,
)
from railgate.odometer.plant.sensor import Channel, Passed, Sensor
from railgate.odometer.plant.services import SERVICES, Service

__all__ = [
    "CONDITIONS",
    "PROFILES",
    "SERVICES",
    "Channel",
    "Floats",
    "Journey",
    "Passed",
    "Profile",
    "Sensor",
    "Service",
    "constant",
    "course",
    "journey",
    "ramp",
    "read_profile",
    "run",
    "shuttle",
]
