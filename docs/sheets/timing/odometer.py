"""The odometer's diagrams."""

from __future__ import annotations

from functools import cache

import numpy as np

from railgate.odometer.measure import replay
from railgate.odometer.plant import Profile, Sensor, constant
from railgate.odometer.spec import Config, Direction, Flag
from railgate.waves import Trace
from sheets.timing.lanes import Diagram, Lane

__all__ = ["periods", "reversal", "snapshot"]

CONFIG = Config(sensors=1)
TICK_S = 1 / CONFIG.clock_hz
SPEED_KMH, SECONDS = 200.0, 0.1


def whole(value: int) -> str:
    return f"{value}"


def named(kind: type[Direction]) -> dict[int, str]:
    return {each.value: each.name.lower() for each in kind}


def flags(value: int) -> str:
    """Those raised, none as nothing."""
    return ", ".join(f.name.lower() for f in Flag if f & value and f.name) or "0"


@cache
def _at_speed() -> Trace:
    """Pins and fields at a constant 200 km/h, strobed every 20 ms."""
    return replay(Sensor().drive(constant(SPEED_KMH, SECONDS), CONFIG), CONFIG).gateware


def _lanes(trace: Trace, *names: str) -> list[Lane]:
    """Of one bit levels, of more their values."""
    return [
        Lane(name.removeprefix("sensor.0."), trace[name], None if trace[name].width == 1 else whole)
        for name in names
    ]


def periods() -> Diagram:
    """Some periods around a strobe: what the snapshot tells of them."""
    trace = _at_speed()
    strobe = int(trace["strobe"].rising()[2])
    pins = ("sensor.0.a", "sensor.0.b")
    fields = ("number", "sensor.0.pulses", "sensor.0.period", "sensor.0.phase")
    edges = trace["sensor.0.a"].rising()
    last = int(edges[np.searchsorted(edges, strobe - CONFIG.input_delay_ticks) - 1])
    return Diagram(
        title=f"Odometer at {SPEED_KMH:g} km/h: a strobe latches the period that ended last",
        lanes=_lanes(trace, *pins, "strobe", *fields),
        tick_s=TICK_S,
        start=strobe - 13000,
        end=strobe + 6000,
        unit="µs",
        zero=strobe,
        marks=((last, "last rise of a before the strobe"),),
    )


def snapshot() -> Diagram:
    """From the strobe to the fields, tick by tick."""
    trace = _at_speed()
    strobe = int(trace["strobe"].rising()[2])
    fields = ("number", "time", "sensor.0.pulses", "sensor.0.position")
    return Diagram(
        title="Odometer: all fields change together, 16 ticks after the strobe",
        lanes=_lanes(trace, "strobe", "busy", *fields),
        tick_s=TICK_S,
        start=strobe - 4,
        end=strobe + 24,
        unit="ticks",
        zero=strobe,
        marks=((strobe + CONFIG.snapshot_latency_ticks, "the fields change"),),
    )


def reversal() -> Diagram:
    """A wheel that stops and turns back."""
    profile = Profile(np.array([0.0, 0.2, 0.4]), np.array([0.3, 0.0, -0.3]))
    trace = replay(Sensor().drive(profile, CONFIG), CONFIG).gateware
    direction = named(Direction)
    lanes = [
        *_lanes(trace, "sensor.0.a", "sensor.0.b", "strobe", "sensor.0.position"),
        Lane("direction", trace["sensor.0.direction"], lambda value: direction[value]),
        Lane("flags", trace["sensor.0.flags"], flags),
    ]
    return Diagram(
        title="Odometer: a wheel that comes to rest and turns back; the position rules",
        lanes=lanes,
        tick_s=TICK_S,
        start=round(0.19 / TICK_S),
        end=round(0.28 / TICK_S),
    )
