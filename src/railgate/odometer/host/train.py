"""The train from two or more axles: slip and slide, speed and distance while it lasts (ODO-15).

Every strobe each axle tells two things: how far its wheel turned, exactly, and what speed it leaves
if it rolls. `membership` keeps what all axles that may be rolling leave of the train; where none
does, what the train can have become since. The intervals rest on the premises of `Train.rests_on`
and on nothing else; the verdicts are the likelier reading, and the intervals do not rest on them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from railgate.bounds import require
from railgate.odometer.host.diameter import WheelRecord
from railgate.odometer.host.estimators import Scale
from railgate.odometer.host.membership import (
    AXLE,
    PAIR,
    RING,
    RULES,
    SEEN,
    TRAIN,
    refer,
    replay,
    tell,
)
from railgate.odometer.host.readout import Snapshot
from railgate.odometer.spec import Assumptions, Config

__all__ = ["Rolling", "Train", "TrainState", "Verdict"]

_FIELDS = attrgetter(*(SEEN.names or ()))


class Verdict(IntEnum):
    """How an axle turns, as far as can be told.

    SLIPPING: faster than the train. SLIDING: slower. LOST: its edges are false, or there have been
    none for standstill_s of a moving train: a locked axle or a lost sensor.
    """

    ADHERING = 0
    SLIPPING = 1
    SLIDING = 2
    LOST = 3


_VERDICTS = tuple(Verdict)


@dataclass(frozen=True, kw_only=True)
class Rolling:
    """What is assumed of rolling, beside spec.Assumptions. Raises ValueError.

    creep: greatest part by which the speed of a wheel that rolls differs from the train's: creepage
    under traction and brake, the rolling radius in curves. slide_rise: greatest acceleration, m/s²,
    of a train all of whose axles slide: 0, it does not gain speed; -acceleration_max, it brakes as
    hard as it can (ODO-11). confirm_s: how long an axle can slip or slide before it is found; what
    one axle alone tells is taken at the age of that. rejoin_s: how long an axle that was off must
    roll, together with another, to be believed again. standstill_s: how long without any edge a
    wheel stands still, or is called lost if the train moves; and how long an axle must roll to be
    believed again where all others are lost.
    """

    creep: float = 0.0
    slide_rise: float = 0.0
    confirm_s: float = 0.1
    rejoin_s: float = 0.2
    standstill_s: float = 2.0

    def __post_init__(self) -> None:
        require(
            self,
            ("creep", 0, 0.2),
            ("slide_rise", -100, 100),
            ("confirm_s", 0, 1),
            ("rejoin_s", 0.05, 60),
            ("standstill_s", 0.05, 600),
        )


class TrainState(NamedTuple):
    """The train at a strobe.

    speed_*_kmh: signed, and its guaranteed interval. distance_*_m: signed way since the reference,
    and its guaranteed interval. standstill: every one of two or more axles adheres and stands still
    (ODO-11). verdicts: of each axle. steps: of each axle since the reference, in ¼ pitch. counted:
    those of them by which distance_m is told; compensated_m: its rest, made while no axle was
    believed. rolled: for each axle whether it has adhered, undoubted, since the reference.
    """

    speed_kmh: float
    speed_low_kmh: float
    speed_high_kmh: float
    distance_m: float
    distance_low_m: float
    distance_high_m: float
    standstill: bool
    verdicts: tuple[Verdict, ...]
    steps: tuple[int, ...]
    counted: tuple[int, ...]
    compensated_m: float
    rolled: tuple[bool, ...]

    @property
    def etcs_m(self) -> float:
        """What ETCS allows the distance to be off: ±(5 m + 5 % of it). Ref: SUBSET-041."""
        return 5 + 0.05 * abs(self.distance_m)

    @property
    def within_etcs(self) -> bool:
        """The guaranteed interval lies within the one that ETCS allows."""
        low, high = self.distance_m - self.distance_low_m, self.distance_high_m - self.distance_m
        return max(low, high) <= self.etcs_m


class Train:
    """A train strobe by strobe. Raises ValueError.

    wheels: the record of each axle's wheel, in the order of the sensors. They rule the diameters;
    config.wheel_diameter_m and assumptions.diameter_tolerance_m are not used. Until `refer` is
    called the distance counts from the first strobe. After a reset of the odometer, whose counters
    start anew, a new Train is needed.
    """

    def __init__(
        self,
        config: Config,
        assumptions: Assumptions,
        wheels: Sequence[WheelRecord],
        rolling: Rolling | None = None,
    ) -> None:
        if not wheels:
            raise ValueError("wheels must hold at least one record, not 0")
        rolling = rolling or Rolling()
        scale = Scale(config, assumptions)
        longest = config.period_max * scale.tick_min_s
        if rolling.standstill_s > longest:
            raise ValueError(
                f"standstill_s must be at most {longest:g}, not {rolling.standstill_s:g}"
            )
        self.config, self.assumptions, self.rolling = config, assumptions, rolling
        self.wheels = tuple(wheels)
        n = len(wheels)
        self._train = np.zeros(1, TRAIN)
        self._train["heading"] = 1
        self._train["speed_low"], self._train["speed_high"] = -math.inf, math.inf
        self._seen = np.zeros(n, SEEN)
        self._rows = self._seen.view(np.int64).reshape(n, -1)
        self._memory = (
            _axles(config, self.wheels),
            self._seen,
            np.zeros((n, RING, 4), np.int64),
            np.zeros((n, RING, 4)),
            _pairs(self.wheels),
            self._train,
            _rules(config, assumptions, rolling, scale),
        )
        self._out = np.zeros(8 + 4 * n)
        self._out[1:3], self._out[8 + 3 * n :] = (-math.inf, math.inf), 1

    def update(self, snapshots: Sequence[Snapshot]) -> TrainState:
        """The train at a strobe, from one snapshot of each axle, all of that strobe.

        Snapshots may be left out between two updates. Raises ValueError.
        """
        if len(snapshots) != len(self.wheels):
            raise ValueError(
                f"a strobe needs {len(self.wheels)} snapshots, one an axle, not {len(snapshots)}"
            )
        for row, snapshot in zip(self._rows, snapshots, strict=True):
            if snapshot.time != snapshots[0].time:
                raise ValueError("the axles' snapshots must be of one strobe, not of several")
            row[:] = _FIELDS(snapshot)
        tell(*self._memory, self._out)
        return self.state

    def replay(self, seen: NDArray[Any]) -> NDArray[np.float64]:
        """Many strobes at once. seen: membership.SEEN, shape (strobes, axles).

        Returns the rows of `membership.tell`, shape (strobes, 8 + 4 · axles).
        """
        out = np.empty((len(seen), self._out.size))
        axles, _, *rest = self._memory
        replay(axles, np.ascontiguousarray(seen), *rest, out)
        self._out[:] = out[-1]
        return out

    def refer(self, tolerance_m: float = 0.0) -> TrainState:
        """The last strobe's place is the reference, known within ±tolerance_m: distance 0."""
        if not 0 <= tolerance_m < math.inf:
            raise ValueError(f"tolerance_m must be a number of at least 0, not {tolerance_m}")
        axles, _, past, told, _, train, rules = self._memory
        refer(axles, past, told, train, rules, tolerance_m, self._out)
        return self.state

    @property
    def state(self) -> TrainState:
        """The train at the last strobe."""
        n = len(self.wheels)
        speed, low, high, way, way_low, way_high, free_m, still, *rest = self._out.tolist()
        whole = [int(value) for value in rest]
        return TrainState(
            3.6 * speed,
            3.6 * low,
            3.6 * high,
            way,
            way_low,
            way_high,
            still != 0 and n > 1,
            tuple([_VERDICTS[value] for value in whole[:n]]),
            tuple(whole[n : 2 * n]),
            tuple(whole[2 * n : 3 * n]),
            free_m,
            tuple(value != 0 for value in whole[3 * n :]),
        )

    @property
    def rests_on(self) -> tuple[str, ...]:
        """What the intervals rest on, in words."""
        told, rolling = self.assumptions, self.rolling
        return (
            "of the axles that are not found to slip or slide one rolls, or slips or slides since "
            f"less than {rolling.confirm_s:g} s",
            f"the train's acceleration is within ±{told.acceleration_max:g} m/s²",
            f"a train whose axles all slide accelerates by at most {rolling.slide_rise:g} m/s² and "
            "does not turn back",
            f"two axles that have turned alike for {rolling.rejoin_s:g} s, or one alone for "
            f"{rolling.standstill_s:g} s, within the train's limits, roll",
            f"a rolling wheel's speed is within ±{100 * rolling.creep:g} % of the train's",
            "each wheel's diameter is within its record's bounds",
            f"no edge lost or false, each stamped less than {told.late_ticks:g} ticks late",
            f"clock within ±{told.crystal_ppm:g} ppm",
            f"rising edges of a within ±{told.tooth_error:g} pitch of their places",
        )


def _rules(config: Config, assumed: Assumptions, rolling: Rolling, scale: Scale) -> NDArray[Any]:
    rules = np.zeros(1, RULES)
    for name, value in (
        ("time_modulus", 1 << config.time_bits),
        ("count_modulus", 1 << config.count_bits),
        ("still_ticks", math.ceil(rolling.standstill_s / scale.tick_min_s)),
        ("confirm_ticks", math.ceil(rolling.confirm_s / scale.tick_min_s)),
        ("rejoin_ticks", math.ceil(rolling.rejoin_s / scale.tick_min_s)),
        ("delay_ticks", config.input_delay_ticks),
        ("tick_s", 1 / config.clock_hz),
        ("tick_min_s", scale.tick_min_s),
        ("tick_max_s", scale.tick_max_s),
        ("clock_low", (1 - assumed.crystal_ppm * 1e-6) * (1 - 2.0**-44)),
        ("a_max", assumed.acceleration_max),
        ("slide_rise", rolling.slide_rise),
        ("tooth", assumed.tooth_error),
        ("late", assumed.late_ticks),
        ("creep", rolling.creep),
    ):
        rules[name] = value
    return rules


def _axles(config: Config, wheels: Sequence[WheelRecord]) -> NDArray[Any]:
    axles = np.zeros(len(wheels), AXLE)
    axles["live"] = axles["rolled"] = 1
    axles["speed_low"], axles["speed_high"] = -math.inf, math.inf
    for axle, wheel in zip(axles, wheels, strict=True):
        axle["pitch"] = math.pi * wheel.diameter_m / config.pulses_per_rev
        axle["wheel_low"] = wheel.least_m / wheel.diameter_m * (1 - 2.0**-44)
        axle["wheel_high"] = wheel.greatest_m / wheel.diameter_m * (1 + 2.0**-44)
    return axles


def _pairs(wheels: Sequence[WheelRecord]) -> NDArray[Any]:
    n = len(wheels)
    pairs = np.zeros((n, n), PAIR)
    for i, one in enumerate(wheels):
        for j, other in enumerate(wheels):
            factor = other.diameter_m / one.diameter_m
            pair = pairs[i, j]
            pair["low"] = one.least_m / other.greatest_m * factor * (1 - 2.0**-43)
            pair["high"] = one.greatest_m / other.least_m * factor * (1 + 2.0**-43)
    return pairs
