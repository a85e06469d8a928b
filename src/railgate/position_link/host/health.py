"""How a link did over a run: availability, alarms, causes (LNK-7)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from railgate.position_link.host.layout import guarantee
from railgate.position_link.host.link import Deliveries
from railgate.position_link.spec import Health, Status, cause_names

__all__ = ["Summary", "summary"]


@dataclass(frozen=True)
class Summary:
    """A run in figures.

    fresh, held: deliveries of that status, with a word to believe; fault: all others; starting:
    those of health START. lost: deliveries missing by their numbers. restarts: resets
    on the way. inconsistent: see `Deliveries`; nothing of these is used. faulty_cycles, causes:
    cycles faulty, and by each cause, in lower case, lost deliveries' too. alarms: stretches of
    ALARM and RECOVERING, but for those without any ALARM, such as after START; longest_alarm_s:
    from the first delivery down to the first one up. oldest_s: the greatest age of a word
    believed, None where none was. guarantee: what the check says of DATA.
    """

    deliveries: int
    fresh: int
    held: int
    fault: int
    starting: int
    lost: int
    restarts: int
    inconsistent: int
    faulty_cycles: int
    causes: dict[str, int]
    rejected_glitches: int
    alarms: int
    longest_alarm_s: float
    oldest_s: float | None
    guarantee: str

    @property
    def availability(self) -> float:
        """The part of all deliveries, lost ones too, that brought a word, fresh or held."""
        return (self.fresh + self.held) / max(self.deliveries + self.lost, 1)


def summary(run: Deliveries) -> Summary:
    """The figures of a run; counts begin with its first delivery, see `Deliveries.grown`."""
    status, health = run.fields["status"], run.fields["health"]
    believed = run.believed
    fresh, held = (int((believed & (status == one)).sum()) for one in (Status.FRESH, Status.HELD))
    alarms = _alarms_ticks(run)
    return Summary(
        deliveries=len(run),
        fresh=fresh,
        held=held,
        fault=len(run) - fresh - held,
        starting=int((health == Health.START).sum()),
        lost=int(run.lost.sum()),
        restarts=int(run.restarted[1:].sum()),
        inconsistent=int(run.inconsistent.sum()),
        faulty_cycles=run.grown("faulty_cycles"),
        causes={name: run.grown(f"{name}_cycles") for name in cause_names()},
        rejected_glitches=run.grown("rejected_glitches"),
        alarms=alarms.size,
        longest_alarm_s=int(alarms.max(initial=0)) / run.config.clock_hz,
        oldest_s=float(run.age_s[believed].max()) if believed.any() else None,
        guarantee=guarantee(run.config.check),
    )


def _alarms_ticks(run: Deliveries) -> NDArray[np.int64]:
    """How long each alarm was, ticks; the last one until its next delivery is due."""
    health = run.fields["health"]
    down = np.isin(health, (Health.ALARM, Health.RECOVERING))
    turns = np.flatnonzero(np.diff(down, prepend=False, append=False)).reshape(-1, 2)
    before = np.append(0, np.cumsum(health == Health.ALARM))
    turns = turns[before[turns[:, 1]] > before[turns[:, 0]]]
    until = np.append(run.ticks, run.ticks[-1:] + run.config.cycle_ticks)
    lengths: NDArray[np.int64] = np.diff(until[turns]).ravel()
    return lengths
