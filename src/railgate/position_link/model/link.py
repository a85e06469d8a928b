"""What the link makes of what the line says: deliveries, compiled (LNK-5, LNK-6, LNK-7)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from railgate.position_link.model.words import Words, parts_of
from railgate.position_link.spec import Config, Health, Status, cause_names
from railgate.waves.waveform import Ticks

__all__ = ["COLUMNS", "LINK", "Table", "first_row", "judge", "limits"]

Table = NDArray[np.int64]
"""One delivery a row: COLUMNS, of `word` as many as it has parts."""

FAULT, HELD, FRESH = int(Status.FAULT), int(Status.HELD), int(Status.FRESH)
START, OK, WARNING = int(Health.START), int(Health.OK), int(Health.WARNING)
ALARM, RECOVERING = int(Health.ALARM), int(Health.RECOVERING)

COLUMNS = (
    *("number", "status", "age", "age_ticks", "health", "causes", "faulty_cycles"),
    "rejected_glitches",
    *(f"{name}_cycles" for name in cause_names()),
    "word",
)
NUMBER, STATUS, AGE, AGE_TICKS, HEALTH, CAUSES, FAULTY, GLITCHES, COUNTS = range(9)
WORD = len(COLUMNS) - 1

LINK = np.dtype([(name, np.int64) for name in ("up", "good", "faulty", "ever_good", "rise")])
"""Whether the link is up; cycles in a row, up to what they lead to; whether there was a good one
since reset, and in which tick UEF rose for the last."""

COUNTED = ("delivery_ticks", "tolerated_cycles", "recovery_cycles")
GREATEST = ("count", "age", "age_ticks")
LIMITS = np.dtype([(name, np.int64) for name in (*COUNTED, *(f"{name}_max" for name in GREATEST))])


def limits(config: Config) -> Any:
    """The numbers of a configuration that `judge` needs. Shape (1,), LIMITS."""
    made = np.zeros(1, LIMITS)
    for name in COUNTED:
        made[name] = getattr(config, name)
    for name in GREATEST:
        made[f"{name}_max"] = (1 << getattr(config, f"{name}_bits")) - 1
    return made


def first_row(config: Config) -> Table:
    """The delivery that is shown before the first. Shape (1, columns)."""
    start = {field.name: field.start for field in config.fields}
    row = np.array([[start[name] for name in COLUMNS[:-1]]], np.int64)
    word = parts_of(start["word"], config.word_bits).view(np.int64)
    return np.concatenate([row, word[None]], axis=1)


@njit(cache=True, nogil=True)
def step(limit: Any, link: Any, bad: bool) -> None:
    """Whether the link is up after one more cycle."""
    link.good = 0 if bad else min(link.good + 1, limit.recovery_cycles)
    link.faulty = min(link.faulty + 1, limit.tolerated_cycles) if bad else 0
    if link.good == limit.recovery_cycles:
        link.up = 1
    elif link.faulty == limit.tolerated_cycles:
        link.up = 0


@njit(cache=True, nogil=True)
def judge(
    limit_of: Any,
    link_of: Any,
    found: Any,
    words: Words,
    glitches: NDArray[np.int64],
    begins: Ticks,
    good_word: NDArray[np.uint64],
    fault_word: NDArray[np.uint64],
    table: Table,
) -> None:
    """Decide on cycles and fill in their deliveries.

    limit_of, link_of: shape (1,), LIMITS and LINK. found, words: what the line said, with all
    causes. glitches: counted up to each decision. begins: the first tick of each cycle. good_word:
    of the last good cycle, kept up to date. table: the delivery before these, then theirs.
    """
    limit, link = limit_of[0], link_of[0]
    for i in range(found.size):
        row, before, causes = table[i + 1], table[i], found[i].causes
        bad = causes != 0
        step(limit, link, bad)
        if not bad:
            link.ever_good, link.rise = 1, found[i].rise
            good_word[:] = words[i]
        if link.up:
            row[STATUS], row[HEALTH] = (HELD, WARNING) if bad else (FRESH, OK)
        else:
            dead = link.ever_good or link.faulty == limit.tolerated_cycles
            down = ALARM if dead else START
            row[STATUS], row[HEALTH] = FAULT, down if bad else RECOVERING
        row[WORD:] = (good_word if link.up else fault_word).view(np.int64)
        since = begins[i] + limit.delivery_ticks - link.rise
        row[NUMBER] = before[NUMBER] + 1 & limit.count_max
        row[AGE] = min(before[AGE] + 1, limit.age_max) if bad else 0
        row[AGE_TICKS] = min(since, limit.age_ticks_max) if link.ever_good else limit.age_ticks_max
        row[CAUSES], row[GLITCHES] = causes, glitches[i] & limit.count_max
        row[FAULTY] = before[FAULTY] + int(bad) & limit.count_max
        for at in range(COUNTS, WORD):
            count = before[at] + (causes >> (at - COUNTS) & 1)
            row[at] = count & limit.count_max
