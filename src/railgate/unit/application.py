"""The CPUs' application: two replicas that release the doors at a platform.

In each system cycle each replica reads its own FPGA's odometer; CPU 1 has the position word too and
passes it on. Each tells the other what it makes of it, and both decide on what they agree on.

**The rule.** The doors of a platform's side are released while all of this holds, and both replicas
say so; in the first cycle in which one does not, the command is 0:

1. The train stands: *both* axles have been still for `railgate.odometer.host.STANDSTILL_S`, and
   none of them came to that by sliding or by the loss of its sensor (ODO-11). A locked wheel is
   still alone; a sensor whose cable is cut in motion has ceased faster than a train can brake.
2. The position word is there (fresh or held), and is within `window_m` of a platform on that side.
3. The position has been still too: for `still_s` it has been within `creep_m` of one place. It does
   not come from the wheels: should both cables be cut while the train stands, this ends the release
   when it leaves.
4. The driver asks for it: from the arrival until `closes_s` before the departure.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from operator import attrgetter

from railgate.bounds import require
from railgate.unit.route import Call

__all__ = ["Replica", "Rule", "View", "decide"]


@dataclass(frozen=True, kw_only=True)
class Rule:
    """The application's constants. Raises ValueError."""

    window_m: float = 2.0
    creep_m: float = 0.5
    still_s: float = 2.0
    closes_s: float = 4.0

    def __post_init__(self) -> None:
        require(self, ("window_m", 0.1, 50), ("creep_m", 0.01, 10))
        require(self, ("still_s", 0, 60), ("closes_s", 0, 60))


@dataclass(frozen=True)
class View:
    """What a replica makes of its inputs: whether the train stands, and which outputs it would
    command, bit i output i."""

    stands: bool
    image: int


class Replica:
    """One CPU's. calls: the timetable, of which it knows platforms and when the driver asks."""

    def __init__(self, rule: Rule, calls: Sequence[Call]) -> None:
        self._rule, self._calls = rule, calls
        self._still: tuple[float, float] | None = None  # since when, and where

    def update(self, time_s: float, standstill: bool, position_m: float | None) -> View:
        """A system cycle. standstill: of the train, by the own odometer. position_m: the word's,
        None where there is none to believe."""
        if position_m is None:
            self._still = None
            return View(standstill, 0)
        if self._still is None or abs(position_m - self._still[1]) > self._rule.creep_m:
            self._still = time_s, position_m
        if not standstill or time_s - self._still[0] < self._rule.still_s:
            return View(standstill, 0)
        at = bisect_right(self._calls, time_s, key=attrgetter("arrives_s")) - 1
        if at < 0 or not self._asks(self._calls[at], time_s, position_m):
            return View(True, 0)
        return View(True, 1 << self._calls[at].stop.side.value)

    def _asks(self, call: Call, time_s: float, position_m: float) -> bool:
        """The train is at this platform, and the driver asks for its doors."""
        near = abs(position_m - call.stop.at_m) <= self._rule.window_m
        return near and time_s < call.departs_s - self._rule.closes_s


def decide(views: Sequence[View | None]) -> int:
    """What both command: what both views have; nothing where one CPU is silent."""
    if None in views:
        return 0
    one, other = (view.image for view in views if view is not None)
    return one & other
