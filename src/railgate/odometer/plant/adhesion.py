"""Wheels on wet and slippery rails: slip, slides under a wheel slide protection, a locked axle.

A wheel's speed is the train's plus its slip, both linear between points, so that its motion is an
exact Profile like the train's. An axle slips or slides where its tractive or braking effort, as
part of its weight, exceeds the adhesion: what is in excess accelerates the wheelset alone, whose
rotating mass is about a tenth of what rests on it. Wheels roll without creep else.

Adhesion: dry 0.2 … 0.4, in really wet conditions 0.1 … 0.2, damp leaves down to 0.01 (Ref: What is
low adhesion?, rail-traction.com). `low` is assumed, between these. What is in excess is taken as at
least 0.02, so that no slide begins more gently than 2 m/s² relative to the train.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from railgate.odometer.plant.profile import Floats, Profile
from railgate.odometer.plant.services import Service

__all__ = ["ADHESION", "CONDITIONS", "Journey", "journey"]

GRAVITY = 9.81
ROTATING = 0.1
"""Rotating mass of a wheelset over the mass that rests on it."""

ADHESION = {"wet": (0.10, 0.16), "low": (0.05, 0.07), "leaves": (0.01, 0.02)}
"""Least and greatest, by the rail's condition."""

CONDITIONS = ("dry", "wet", "slide", "locked", "worn")

Slip = list[tuple[float, float]]
"""Points of time, s, and of slip, m/s, 0 before the first and after the last."""


@dataclass(frozen=True, eq=False)
class Journey:
    """A train with known truth: its motion, those of its wheels' treads, and when which is off.

    off: of each axle the spans (from s, to s) in which its slip is not 0. diameters_m: the true
    ones, of which `recorded_m` holds what is recorded: (figure, least, greatest).
    """

    train: Profile
    wheels: tuple[Profile, ...]
    off: tuple[tuple[tuple[float, float], ...], ...]
    diameters_m: tuple[Fraction, ...]
    recorded_m: tuple[tuple[float, float, float], ...]


def journey(service: Service, condition: str, seed: int) -> Journey:
    """A service under one of CONDITIONS; all that is random comes from the seed.

    wet: the driven axle slips when it starts, the other slides a little. slide: both axles slide
    under braking, the slide protection letting go of them and pressing again; the train brakes by
    what adhesion is left. locked: the second axle stands from each braking to the stop. worn: the
    first wheel is 1.8 mm smaller than recorded, within its record's bounds; else the wheels are off
    by 0.2 and 0.3 mm, within ±0.5 mm. Raises ValueError.
    """
    if condition not in CONDITIONS:
        raise ValueError(f"condition must be one of {', '.join(CONDITIONS)}, not {condition}")
    random, rail = np.random.default_rng(seed), _rail(service, condition)
    held = sum(rail) / 2 * GRAVITY if condition == "slide" else service.braking
    train, phases = service.profile(min(held, service.braking))
    slips: tuple[list[Slip], list[Slip]] = ([], [])
    for what, start, end in phases:
        if what == "traction" and condition == "wet":
            slips[0].extend(_slipping(service, rail, start, end, random))
        if what == "braking" and condition in ("wet", "slide"):
            for axle in (0, 1) if condition == "slide" else (1,):
                slips[axle].extend(_sliding(service, train, rail, start, end, random))
        if what == "braking" and condition == "locked":
            slips[1].append(_locked(train, start, end))
    half = 0.0020 if condition == "worn" else 0.0005
    return Journey(
        train,
        tuple(_wheel(train, of) for of in slips),
        tuple(tuple((s[0][0], s[-1][0]) for s in of) for of in slips),
        (Fraction(6482 if condition == "worn" else 6502, 10_000), Fraction(6497, 10_000)),
        ((0.65, 0.65 - half, 0.65 + half),) * 2,
    )


def _rail(service: Service, condition: str) -> tuple[float, float]:
    """The adhesion: for a slide the best rail that does not hold the service's brake."""
    if condition != "slide":
        return ADHESION["wet"]
    demand = service.braking / GRAVITY
    return next(ADHESION[name] for name in ("low", "leaves") if ADHESION[name][1] < demand)


def _slipping(
    service: Service,
    rail: tuple[float, float],
    start: float,
    end: float,
    random: np.random.Generator,
) -> list[Slip]:
    """A driven axle that spins up again and again until its control has found what holds."""
    demand = service.traction / GRAVITY / service.driven
    slips: list[Slip] = []
    at = start + random.uniform(2, 4)
    for _ in range(4):
        adhesion = random.uniform(*rail)
        up = (max(demand - adhesion, 0.02)) * GRAVITY / ROTATING
        down = adhesion / 2 * GRAVITY / ROTATING
        most = random.uniform(0.5, 3.0)
        slip = [(at, 0.0), (at + most / up, most), (at + most / up + most / down, 0.0)]
        at = slip[-1][0] + random.uniform(0.5, 3)
        if slip[-1][0] >= end:
            break
        slips.append(slip)
    return slips


def _sliding(
    service: Service,
    train: Profile,
    rail: tuple[float, float],
    start: float,
    end: float,
    random: np.random.Generator,
) -> list[Slip]:
    """Slide after slide down to a part of the speed, each time let go by the slide protection."""
    demand = service.braking / GRAVITY
    slips: list[Slip] = []
    at = start + random.uniform(1.2, 2)
    while True:
        adhesion = random.uniform(*rail)
        speed = float(train.speed_kmh(np.array(at))) / 3.6
        down = max(demand - adhesion, 0.02) * GRAVITY / ROTATING
        up = max(adhesion, 0.02) * GRAVITY / ROTATING
        most = speed * random.uniform(0.08, 0.25)
        slip = [(at, 0.0), (at + most / down, -most), (at + most / down + most / up, 0.0)]
        if speed < 3 or slip[-1][0] >= end:
            return slips
        slips.append(slip)
        at = slip[-1][0] + random.uniform(0.1, 1.5)


def _locked(train: Profile, start: float, end: float) -> Slip:
    """From soon after the brake's application to the stop: the wheel's deceleration is 8 m/s²."""
    at, inside = start + 2.0, train.times_s[(train.times_s > start) & (train.times_s <= end)]
    stands = at + float(train.speed_kmh(np.array(at))) / 3.6 / 7
    points = [(at, 0.0)]
    for t in [stands, *inside[inside > stands].tolist()]:
        points.append((t, -float(train.speed_kmh(np.array(t))) / 3.6))
    return points


def _wheel(train: Profile, slips: list[Slip]) -> Profile:
    """The tread's motion: the train's and the slips."""
    if not slips:
        return train
    times, values = zip(*(point for slip in slips for point in slip), strict=True)
    t: Floats = np.union1d(train.times_s, times)
    speed = train.speed_kmh(t) / 3.6 + np.interp(t, times, values, 0.0, 0.0)
    return Profile(t, np.where(np.abs(speed) < 1e-9, 0.0, speed))
