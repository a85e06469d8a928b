"""The network's time, as it comes to an FPGA's time port (DRV-3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from railgate.vital_output.plant.edges import Edges, multiples
from railgate.vital_output.spec import Config
from railgate.waves import Waveform

__all__ = ["INDEX_BITS", "Update", "port", "updates"]

INDEX_BITS = 32


@dataclass(frozen=True, kw_only=True)
class Update:
    """One update: the cycle of the run, when it is due, femtoseconds, and by how many ticks the
    time that it gives is ahead of the network's."""

    cycle: int
    due: int
    ahead_ticks: int = 0


def updates(config: Config, cycles: int, every: int) -> list[Update]:
    """One in the middle of each `every`-th of so many cycles, from the first on."""
    due = multiples(config.cycle_s, config.cycle_s / 2, cycles)
    return [Update(cycle=n, due=due[n]) for n in range(0, cycles, every)]


def port(
    config: Config, edges: Edges, given: Sequence[Update], first_index: int, end: int
) -> dict[str, Waveform]:
    """An FPGA's `time.index`, `time.phase` and `time.valid` below the femtosecond `end`.

    The network's time is index `first_index`, phase 0 at the start, and counts ticks of exactly
    clock_hz. Each update is in the first tick that begins not before it is due, and gives the time
    at which this tick begins, rounded to a whole tick.
    """
    due, ahead = np.array([(u.due, u.ahead_ticks) for u in given], np.int64).reshape(-1, 2).T
    ticks = edges.first(due)
    now = edges.counted(ticks, config.clock_hz) + ahead
    cycles, phase = np.divmod(np.append(0, now), config.cycle_ticks)
    index = (first_index + cycles) % (1 << INDEX_BITS)
    index[0] = 0
    at = np.append(0, ticks)
    pulses = np.stack([ticks, ticks + 1], axis=1).ravel()
    return {
        "time.index": edges.wave(at, index, INDEX_BITS, end),
        "time.phase": edges.wave(at, phase, (config.cycle_ticks - 1).bit_length(), end),
        "time.valid": edges.wave(np.append(0, pulses), np.arange(1 + pulses.size) % 2, 1, end),
    }
