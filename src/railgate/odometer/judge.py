"""The train's odometry judged on journeys whose truth is known (ODO-15).

A place of its own, since it needs the plant, the model and the host together, and the train's truth
beside what the host tells; `simulate` does that for one wheel.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railgate.odometer.host import Train, Verdict, WheelRecord
from railgate.odometer.host.membership import SEEN
from railgate.odometer.model import Model
from railgate.odometer.plant import Journey, Profile, Sensor
from railgate.odometer.spec import Config, Direction
from railgate.waves import Trace, Waveform
from railgate.waves.waveform import Ticks

__all__ = ["Judgement", "by_model", "by_places", "judge", "records", "strobes"]

Floats = NDArray[np.float64]

DAY = "2026-01-01"


def records(journey: Journey) -> list[WheelRecord]:
    """The wheels as they are recorded."""
    return [
        WheelRecord(axle=str(i + 1), diameter_m=d, least_m=least, greatest_m=most, day=DAY)
        for i, (d, least, most) in enumerate(journey.recorded_m)
    ]


def strobes(journey: Journey, config: Config, every_s: float = 0.02) -> Ticks:
    """The strobes' ticks, every_s apart."""
    every = round(every_s * config.clock_hz)
    end = math.floor(journey.train.duration_s * config.clock_hz) - config.snapshot_latency_ticks
    return np.arange(every, end, every)


def by_model(
    journey: Journey, config: Config, sensors: Sequence[Sensor], ticks: Ticks
) -> NDArray[Any]:
    """What the odometer's model tells at strobes in these ticks: SEEN, shape (strobes, axles)."""
    inputs: dict[str, Waveform] = {}
    config = replace(config, sensors=len(sensors))
    for i, (sensor, wheel) in enumerate(zip(sensors, journey.wheels, strict=True)):
        pins = sensor.drive(wheel, replace(config, wheel_diameter_m=journey.diameters_m[i]))
        inputs |= {f"sensor.{i}.{name}": wave for name, wave in pins.signals.items()}
    edges = np.concatenate([[0], np.column_stack([ticks, ticks + 1]).ravel()])
    inputs["strobe"] = Waveform.of(edges, np.arange(edges.size) & 1)
    out = Model(config).advance(pins.end, Trace(inputs, pins.period, 0, pins.end))
    seen = np.zeros((ticks.size, len(sensors)), SEEN)
    shown = ticks + config.snapshot_latency_ticks
    for i in range(len(sensors)):
        for name in SEEN.names or ():
            signal = name if name == "time" else f"sensor.{i}.{name}"
            seen[:, i][name] = out[signal].at(shown)
    return seen


def by_places(
    journey: Journey, config: Config, sensors: Sequence[Sensor], ticks: Ticks
) -> NDArray[Any]:
    """The same from the places of the teeth alone, for journeys of days; no wheel runs back."""
    seen = np.zeros((ticks.size, len(sensors)), SEEN)
    delay = config.input_delay_ticks
    for i, (sensor, wheel) in enumerate(zip(sensors, journey.wheels, strict=True)):
        of = replace(config, wheel_diameter_m=journey.diameters_m[i])
        passed, axle = sensor.passed(wheel, of, ticks - delay), seen[:, i]
        some, turned = passed.rises > 0, passed.steps > 0
        rise = np.where(some, passed.last_rise + delay, 0)
        edge = np.where(turned, passed.last_edge + delay, 0)
        before = np.concatenate([[0], passed.rises[:-1]])
        axle["time"], axle["a_rising"], axle["position"] = ticks, passed.rises, passed.steps
        axle["since_rise"], axle["since_edge"] = ticks - rise, ticks - edge
        axle["direction"] = np.where(turned, Direction.FORWARD, Direction.NONE)
        axle["window_seated"] = some
        axle["window_n"] = passed.rises - np.maximum(before, 1) * some
        first = _first_rise(passed.rises, rise, sensor, wheel, of) + delay
        start = np.where(before > 0, np.concatenate([[0], rise[:-1]]), first)
        axle["window_ticks"] = np.where(axle["window_n"] > 0, rise - start, 0)
    return seen


def _first_rise(rises: Ticks, rise: Ticks, sensor: Sensor, wheel: Profile, config: Config) -> int:
    """The pins' tick of the first rising edge of a; 0 where there is none by the last strobe."""
    if not rises.size or not rises[-1]:
        return 0
    low, high = 0, int(rise[np.searchsorted(rises, 1)])
    while low < high:
        middle = (low + high) // 2
        seen = sensor.passed(wheel, config, np.array([middle])).rises[0]
        low, high = (low, middle) if seen else (middle + 1, high)
    return low


@dataclass(frozen=True)
class Judgement:
    """What a train's odometry was worth on a journey.

    windows: how many. outside: in how many the true speed or way left its interval. error_m,
    interval_m: the distance's greatest error, and the greatest half-width of its interval, over the
    whole journey; end_error_m, end_interval_m: at its end. within_etcs: part of the windows where
    the interval is within ETCS's. error_kmh, interval_kmh: of the speed. detect_s: for each span in
    which an axle was off the time to a verdict on it, inf where there was none. false_alarms:
    windows with a verdict though no axle is off, nor was in the last SETTLE_S in which the train
    moved; blamed: windows in which a rolling axle was given one while another was off.
    """

    windows: int
    outside: int
    error_m: float
    interval_m: float
    end_error_m: float
    end_interval_m: float
    within_etcs: float
    error_kmh: float
    interval_kmh: float
    detect_s: tuple[float, ...]
    false_alarms: int
    blamed: int


SETTLE_S = 3.0
"""After which an axle that was off is believed again if it rolls, with room: rejoin_s, or SPAN."""


def judge(journey: Journey, train: Train, seen: NDArray[Any]) -> Judgement:
    """Feed a new train with what was seen, strobe by strobe, and compare it with the truth."""
    told = train.replay(seen)
    verdicts = told[:, 8 : 8 + seen.shape[1]]
    config = train.config
    t = (seen[:, 0]["time"] - config.input_delay_ticks + 1) / config.clock_hz
    speed = journey.train.speed_kmh(t) / 3.6
    way = journey.train.position_m(t) - journey.train.position_m(t[:1])
    _, low, high, distance, way_low, way_high = told[:, :6].T
    half = (way_high - way_low) / 2
    reach = np.maximum(way_high - distance, distance - way_low)
    bounded = np.isfinite(high - low)
    return Judgement(
        windows=len(seen),
        outside=int(np.count_nonzero((speed < low) | (speed > high)))
        + int(np.count_nonzero((way < way_low) | (way > way_high))),
        error_m=float(np.abs(distance - way).max()),
        interval_m=float(half.max()),
        end_error_m=float(abs(distance[-1] - way[-1])),
        end_interval_m=float(half[-1]),
        within_etcs=float(np.mean(reach <= 5 + 0.05 * np.abs(distance))),
        error_kmh=3.6 * float(np.abs(told[:, 0] - speed)[bounded].max()),
        interval_kmh=1.8 * float((high - low)[bounded].max()),
        **_alarms(journey, t, speed, verdicts),
    )


def _alarms(journey: Journey, t: Floats, speed: Floats, verdicts: Floats) -> dict[str, Any]:
    """The last three of a Judgement."""
    alarm = verdicts != Verdict.ADHERING
    off, detected = np.zeros_like(alarm), []
    for i, spans in enumerate(journey.off):
        for start, end in spans:
            first, last = np.searchsorted(t, [start, end])
            moves = np.flatnonzero(speed[last:] > 0)
            settled = np.searchsorted(t, t[last + moves[0]] + SETTLE_S) if moves.size else t.size
            off[first:settled, i] = True
            found = np.flatnonzero(alarm[first : last + 1, i])
            detected.append(float(t[first + found[0]] - start) if found.size else math.inf)
    none = ~off.any(axis=1)
    return {
        "detect_s": tuple(detected),
        "false_alarms": int(np.count_nonzero(alarm.any(axis=1) & none)),
        "blamed": int(np.count_nonzero((alarm & ~off).any(axis=1) & ~none)),
    }
