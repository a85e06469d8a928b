"""From snapshot to snapshot: the train's speed as one axle tells it, when edges cease too (ODO-11).

Every strobe leaves an axle an interval of speed. Within ±acceleration_max it moves to the next
strobe, where it meets what the registers say by then:

- they meet: the speed is in both;
- the wheel is slower than the train can have become: it slides, or its sensor is lost
  (`slide_or_lost`). The upper bound then falls only at acceleration_max. It stays so until edges
  come again at a speed that fits: silence alone never ends it;
- the wheel is faster than the train can have become: it spins (`spin`), until they meet again.
  Its speed is the upper bound, and the lower one falls at acceleration_max.

The upper bound held in a slide is as good as its premise, that the train brakes as hard as it can.
A wheel on its way back to the train's speed is taken for the train once it fits.
"""

from __future__ import annotations

from dataclasses import replace

from railgate.odometer.host.estimators import PRESENT, Estimate, Scale, present
from railgate.odometer.host.readout import Snapshot, between
from railgate.odometer.spec import Assumptions, Config

__all__ = ["STANDSTILL_S", "Axle"]

STANDSTILL_S = 2.0


class Axle:
    """One axle, strobe by strobe.

    standstill_s: after how long without any edge the wheel is called still. No bound on the speed
    could tell: one pitch at acceleration_max, from and to rest, leaves no edge either, so that the
    bound never falls below √(2 · pitch · acceleration_max), 0.6 km/h by default.
    Raises ValueError if standstill_s is beyond what `since_edge` can count.
    """

    def __init__(
        self, config: Config, assumptions: Assumptions, standstill_s: float = STANDSTILL_S
    ) -> None:
        self.config = config
        self.scale = Scale(config, assumptions)
        longest = config.period_max * self.scale.tick_min_s
        if not 0 < standstill_s <= longest:
            raise ValueError(
                f"standstill_s must be above 0 and at most {longest:g}, not {standstill_s:g}"
            )
        self.standstill_ticks = standstill_s / self.scale.tick_min_s
        self._last: tuple[Snapshot, Estimate, float] | None = None

    def update(self, snapshot: Snapshot) -> Estimate:
        """The train's speed at the strobe as this axle tells it: an interval, never a value.

        flags: `slide_or_lost`, `spin`; `contradiction`, see `present`; `wheel_standstill`, no edge
        for standstill_s. Snapshots may be left out between two updates.
        """
        now = present(snapshot, self.scale)
        ceiling = now.high_kmh
        if self._last is not None:
            now, ceiling = self._follow(*self._last, snapshot, now)
        if snapshot.since_edge >= self.standstill_ticks:
            now = replace(now, flags=(*now.flags, "wheel_standstill"))
        self._last = snapshot, now, ceiling
        return now

    def _follow(
        self, older: Snapshot, then: Estimate, ceiling: float, newer: Snapshot, now: Estimate
    ) -> tuple[Estimate, float]:
        """The speed now, and the most the train can have come to, spinning or not."""
        counts = between(older, newer, self.config)
        rate_kmh = 3.6 * self.scale.assumptions.acceleration_max * counts.ticks
        change = rate_kmh * self.scale.tick_max_s
        floor, ceiling = max(then.low_kmh - change, 0.0), ceiling + change
        slid = "slide_or_lost" in then.flags
        braked = then.high_kmh - rate_kmh * self.scale.tick_min_s
        contradiction = "contradiction" in now.flags
        slowest = now.low_kmh if contradiction else now.high_kmh  # the lesser of what contradicts
        if slowest < floor or (slid and not counts.pulses):
            held = max(slowest, braked, floor)
            return self._off(now, "slide_or_lost", floor, held), held
        if slid:
            return now, now.high_kmh
        if contradiction:
            return replace(now, low_kmh=floor, high_kmh=max(now.high_kmh, braked)), ceiling
        if now.low_kmh > ceiling:
            return self._off(now, "spin", floor, now.high_kmh), ceiling
        if "spin" in then.flags:
            return replace(now, low_kmh=floor), now.high_kmh
        low, high = max(floor, now.low_kmh), min(ceiling, now.high_kmh)
        return replace(now, low_kmh=low, high_kmh=high), high

    def _off(self, now: Estimate, flag: str, low_kmh: float, high_kmh: float) -> Estimate:
        """The interval of a train whose wheel slides or spins."""
        further = ("braking at acceleration_max",) if flag == "slide_or_lost" else ()
        return replace(
            now,
            low_kmh=low_kmh,
            high_kmh=high_kmh,
            of=PRESENT,
            rests_on=(*now.rests_on, *further),
            flags=(flag,),
        )
