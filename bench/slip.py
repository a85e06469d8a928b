"""The train from two axles on journeys whose truth is known: errors, bounds, time to find a slip.

Run: python -m bench slip. Teeth within ±0.01 pitch, wheels within ±0.5 mm, clock within ±10 ppm,
where nothing else is said; a snapshot every 20 ms.
"""

from __future__ import annotations

import time
from dataclasses import replace
from fractions import Fraction

import numpy as np

from bench.row import Row, row
from railgate.odometer.host import Rolling, Snapshot, Train
from railgate.odometer.judge import Judgement, by_model, by_places, judge, records, strobes
from railgate.odometer.plant import CONDITIONS, SERVICES, Journey, Profile, Sensor, journey
from railgate.odometer.spec import Assumptions, Config

__all__ = ["run"]

CONFIG = Config()
ASSUMED = Assumptions(tooth_error=0.01, crystal_ppm=10)
SEEDS = 5
WINDOW_S = 0.02


def sensors(seed: int, tooth: float) -> list[Sensor]:
    random = np.random.default_rng(seed)
    return [Sensor(offset=random.random(), tooth_error=tooth, seed=2 * seed + i) for i in range(2)]


def judged(service: str, condition: str, seed: int) -> Judgement:
    trip = journey(SERVICES[service], condition, seed)
    through = by_model if seed == 0 else by_places
    seen = through(trip, CONFIG, sensors(seed, 0.01), strobes(trip, CONFIG, WINDOW_S))
    return judge(trip, Train(CONFIG, ASSUMED, records(trip)), seen)


def _journeys() -> list[Row]:
    rows = []
    for service in SERVICES:
        for condition in CONDITIONS:
            told = [judged(service, condition, seed) for seed in range(SEEDS)]
            what = f"{service}, {condition}"
            spans = [t for one in told for t in one.detect_s]
            rows += [
                row(f"{what}: truth outside", sum(t.outside for t in told), "windows", most=0),
                row(f"{what}: false alarms", sum(t.false_alarms for t in told), "windows", most=0),
                row(f"{what}: distance, worst error", max(t.error_m for t in told), "m"),
                row(f"{what}: distance, bound", max(t.interval_m for t in told), "m"),
                row(
                    f"{what}: part of the windows with the bound within ETCS's",
                    min(t.within_etcs for t in told),
                    least=None if condition == "slide" else 1,
                ),
                row(f"{what}: speed, worst error", max(t.error_kmh for t in told), "km/h"),
            ]
            if spans:
                rows.append(row(f"{what}: slips and slides", len(spans)))
                rows.append(row(f"{what}: latest found after", max(spans), "s", most=0.1))
    return rows


def windows_to_find(kmh: float, slip: float, tooth: float, creep: float, seed: int) -> int:
    """Of one wheel that begins to slip by `slip` m/s²: how many whole windows until it is found.

    -1: before it slipped.
    """
    onset, end, v = 4 + WINDOW_S * np.random.default_rng(seed).random(), 9.0, kmh / 3.6
    train = Profile(np.array([0, end]), np.array([v, v]))
    wheel = Profile(np.array([0, onset, end]), np.array([v, v, v + slip * (end - onset)]))
    diameters = (Fraction(6502, 10_000), Fraction(6497, 10_000))
    recorded = ((0.65, 0.6495, 0.6505),) * 2
    trip = Journey(train, (wheel, train), (((onset, end),), ()), diameters, recorded)
    ticks = strobes(trip, CONFIG, WINDOW_S)
    odometry = Train(
        CONFIG, replace(ASSUMED, tooth_error=tooth), records(trip), Rolling(creep=creep)
    )
    out = odometry.replay(by_places(trip, CONFIG, sensors(seed, tooth), ticks))
    first = int(np.flatnonzero(out[:, 8:10].any(axis=1))[0])
    return max(first - int(np.searchsorted(ticks / CONFIG.clock_hz, onset)), -1)


def _slow() -> list[Row]:
    rows = []
    for kmh, tooth, creep, trials in (
        (200, 0.0, 0.0, 500),
        (120, 0.0, 0.0, 200),
        (80, 0.0, 0.0, 200),
        (40, 0.0, 0.0, 200),
        (200, 0.001, 0.0, 200),
        (200, 0.01, 0.0, 200),
        (200, 0.0, 0.001, 20),
    ):
        found = [
            windows_to_find(kmh, 0.1 if seed % 2 else -0.1, tooth, creep, seed)
            for seed in range(trials)
        ]
        what = f"0.1 m/s² at {kmh} km/h, tooth error {tooth:g}, creep {creep:g}"
        goal = 1 if kmh == 200 and not tooth and not creep else None
        rows.append(row(f"{what}: whole windows until found, most", max(found), "", most=goal))
        rows.append(row(f"{what}: found before", sum(n < 0 for n in found), "", most=0))
    return rows


def alarms(windows: int, tooth: float) -> tuple[int, int, int]:
    """Windows, false alarms and truth outside, of trains that only roll, as hard as they may."""
    found = np.zeros(3, np.int64)
    for seed, service in enumerate(SERVICES.values()):
        one = strobes(journey(service, "dry", seed), CONFIG, WINDOW_S).size
        trip = journey(replace(service, hops=-(-windows // 3 * service.hops // one)), "dry", seed)
        seen = by_places(trip, CONFIG, sensors(seed, tooth), strobes(trip, CONFIG, WINDOW_S))
        assumed = Assumptions(
            tooth_error=tooth, crystal_ppm=0, acceleration_max=trip.train.acceleration_m_s2
        )
        told = judge(trip, Train(CONFIG, assumed, records(trip)), seen)
        found += (told.windows, told.false_alarms, told.outside)
    return int(found[0]), int(found[1]), int(found[2])


def _false() -> list[Row]:
    rows = []
    for tooth in (0.0, 0.01):
        windows, found, outside = alarms(1_050_000, tooth)
        what = f"{windows:.2e} windows of rolling, tooth error {tooth:g}"
        rows.append(row(f"{what}: false alarms", found, "windows", most=0))
        rows.append(row(f"{what}: truth outside", outside, "windows", most=0))
    return rows


def _speed() -> list[Row]:
    trip = journey(SERVICES["metro"], "slide", 1)
    seen = by_places(trip, CONFIG, sensors(1, 0.01), strobes(trip, CONFIG, WINDOW_S))
    fields = [field.name for field in (*CONFIG.common_fields, *CONFIG.sensor_fields)]
    used = seen.dtype.names or ()
    shots = [
        [Snapshot(*(int(axle[name]) if name in used else 0 for name in fields)) for axle in strobe]
        for strobe in seen
    ]
    train = Train(CONFIG, ASSUMED, records(trip))
    train.update(shots[0])
    start = time.process_time()
    for strobe in shots[1:]:
        train.update(strobe)
    each = (time.process_time() - start) / (len(shots) - 1)
    return [row("an hour of 20 ms windows, two axles", each * 180_000, "s of CPU", most=3)]


def run() -> list[Row]:
    """The rows of the table: name, value, unit, goal, met."""
    return [*_journeys(), *_slow(), *_false(), *_speed()]
