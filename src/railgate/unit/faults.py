"""What can go wrong in a run: of the wheels and their sensors here, of the rest in its function."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from railgate.odometer.plant import Profile, Sensor
from railgate.position_link.plant import FAULTS as LINK_FAULTS
from railgate.position_link.plant import Fault as LinkFault
from railgate.unit.config import AXLES
from railgate.vital_output.plant import FAULTS as VITAL_FAULTS
from railgate.vital_output.plant import Fault as VitalFault

__all__ = ["FAULTS", "Fault", "link_faults", "sensors", "vital_faults", "wheel"]

WHEEL_FAULTS = {
    "locked": "the wheel stands still while the train runs on",
    "slide": "the wheel turns slower than the train runs; value: by how many percent",
    "slip": "the wheel turns faster than the train runs; value: by how many percent",
    "cable-cut": "both channels of the sensor hold their levels, to the end",
    "a-lost": "channel A of the sensor holds its level, to the end",
    "b-lost": "channel B of the sensor holds its level, to the end",
}
FAULTS = {
    "wheel": WHEEL_FAULTS,
    "link": {name: kind.does for name, kind in LINK_FAULTS.items()},
    "vital": {name: kind.does for name, kind in VITAL_FAULTS.items()},
}
"""Of each part of the unit the kinds of fault, and what each does."""

LOST = {"cable-cut": ("a_dead_s", "b_dead_s"), "a-lost": ("a_dead_s",), "b-lost": ("b_dead_s",)}
PERCENTS = ("slip", "slide")
PERCENT = 15
"""That a wheel slips or slides by, where no value is given."""
RAMP_S = 0.5
"""So long a wheel takes to leave the train's speed, and to come back to it."""
STEP_S = 0.01


@dataclass(frozen=True, kw_only=True)
class Fault:
    """A fault of one part from a time on, until another where one is given.

    axle: of the wheel's, 1 or 2. value: what the kind takes it for. Raises ValueError.
    """

    part: str
    kind: str
    start_s: Fraction
    end_s: Fraction | None = None
    value: int | None = None
    axle: int = 1

    def __post_init__(self) -> None:
        if self.part not in FAULTS:
            raise ValueError(f'part must be one of {", ".join(FAULTS)}, not "{self.part}"')
        if self.kind not in FAULTS[self.part]:
            kinds = ", ".join(FAULTS[self.part])
            raise ValueError(f'kind must be one of {kinds}, not "{self.kind}"')
        if self.part == "wheel":
            self._require_of_wheel()
        else:
            (LinkFault if self.part == "link" else VitalFault)(*self._told)

    def _require_of_wheel(self) -> None:
        if not 1 <= self.axle <= AXLES:
            raise ValueError(f"axle must be between 1 and {AXLES}, not {self.axle}")
        if self.start_s < 0:
            raise ValueError(f"a fault must begin at 0 s or later, not {float(self.start_s):g} s")
        if self.end_s is not None and (self.kind in LOST or self.end_s <= self.start_s):
            wanted = "last to the end" if self.kind in LOST else "end after it begins"
            raise ValueError(f"{self.kind} must {wanted}, not end at {float(self.end_s):g} s")
        if self.value is not None and not (self.kind in PERCENTS and 1 <= self.value < 100):
            wanted = f"between 1 and 99, of {' and '.join(PERCENTS)} only"
            raise ValueError(f"value must be {wanted}, not {self.value} of {self.kind}")

    @property
    def _told(self) -> tuple[str, Fraction, Fraction | None, int | None]:
        return self.kind, self.start_s, self.end_s, self.value


def link_faults(faults: Sequence[Fault], rate: Fraction) -> tuple[LinkFault, ...]:
    """Those of the link, by a clock that counts `rate` seconds in one."""
    return tuple(
        LinkFault(
            fault.kind,
            fault.start_s * rate,
            None if fault.end_s is None else fault.end_s * rate,
            fault.value,
        )
        for fault in faults
        if fault.part == "link"
    )


def vital_faults(faults: Sequence[Fault]) -> tuple[VitalFault, ...]:
    return tuple(VitalFault(*fault._told) for fault in faults if fault.part == "vital")


def sensors(sensor: Sensor, faults: Sequence[Fault], seed: int) -> tuple[Sensor, ...]:
    """One of each axle, with its faults; its wheel stands, and what is random falls, by itself."""
    found = []
    for axle in range(1, AXLES + 1):
        lost = {
            name: float(fault.start_s)
            for fault in faults
            if fault.part == "wheel" and fault.axle == axle
            for name in LOST.get(fault.kind, ())
        }
        turned = (sensor.offset + 0.37 * (axle - 1)) % 1
        found.append(replace(sensor, offset=turned, seed=AXLES * seed + axle, **lost))
    return tuple(found)


def wheel(profile: Profile, axle: int, faults: Sequence[Fault]) -> Profile:
    """The speed at an axle's wheel: the train's but where it locks, slides or slips."""
    factors = {"locked": 0.0, "slide": -1.0, "slip": 1.0}
    times, speeds = profile.times_s, profile.speeds_m_s
    for fault in faults:
        if fault.part != "wheel" or fault.axle != axle or fault.kind not in factors:
            continue
        part = (fault.value or PERCENT) / 100
        factor = 0.0 if fault.kind == "locked" else 1 + factors[fault.kind] * part
        start = float(fault.start_s)
        end = profile.duration_s if fault.end_s is None else float(fault.end_s)
        back = min(end + RAMP_S, profile.duration_s)
        every = np.union1d(times, np.append(np.arange(start, back, STEP_S), back))
        share = np.interp(every, [start, start + RAMP_S, end, end + RAMP_S], [0, 1, 1, 0])
        speeds = np.interp(every, times, speeds) * (1 + share * (factor - 1))
        times = every
    return Profile(times, speeds)
