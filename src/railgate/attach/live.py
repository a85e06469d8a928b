"""Live values, reading by reading, from a board or from a simulation."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

from railgate.attach.board import find
from railgate.registers.host import Bus, UartBus
from railgate.unit.config import Unit, unit_named

__all__ = ["Live", "on_port", "on_simulation", "readings"]


@dataclass(frozen=True)
class Live:
    """A board, what it should be configured as, and how time passes on it: `wait` is told how long
    and tells whether there was so much left."""

    bus: Bus
    unit: Unit
    wait: Callable[[Fraction], bool]


@contextmanager
def on_port(port: str, baud: int, unit: str) -> Iterator[Live]:
    """A board on a serial port, of a unit by its name. Raises ValueError, and BusError where it
    does not answer."""
    its_unit = unit_named(unit)

    def wait(seconds: Fraction) -> bool:
        time.sleep(float(seconds))
        return True

    with UartBus(port, baud) as bus:
        yield Live(bus, its_unit, wait)


def on_simulation(scenario: str, skip: Fraction, *, paced: bool) -> Live:
    """FPGA 1 in a scenario, built in or a file, `skip` seconds after its beginning. paced: it is
    no faster than real time. Raises ValueError."""
    # Here, since a board needs neither engines nor scenarios.
    from railgate.attach.simulation import SimulatedFpga
    from railgate.unit.scenario_file import builtin, builtins, read_scenario

    told = builtin(scenario) if scenario in builtins() else read_scenario(Path(scenario))
    bus = SimulatedFpga(told)
    if skip and not bus.run(skip):
        raise ValueError(
            f"--skip must leave something of {scenario}'s {float(told.seconds):g} s, "
            f"not be {float(skip):g} s"
        )

    def wait(seconds: Fraction) -> bool:
        due = time.monotonic() + float(seconds)
        goes_on = bus.run(seconds)
        if paced and goes_on:
            time.sleep(max(0.0, due - time.monotonic()))
        return goes_on

    return Live(bus, told.config, wait)


def readings(live: Live, every_s: Fraction) -> Iterator[list[dict[str, Any]]]:
    """What each function on the board tells, every so many seconds, as long as there are any.

    Raises ValueError for what is not the unit's, and BusError.
    """
    if every_s <= 0:
        raise ValueError(f"a reading must be every so many seconds, above 0, not {every_s}")
    gauges = find(live.bus, live.unit)
    for gauge in gauges:
        gauge.read()  # what was counted before is no reading's
    while live.wait(every_s):
        yield [
            {
                "function": gauge.registers.block.name,
                "address": gauge.registers.base,
                **gauge.read(),
            }
            for gauge in gauges
        ]
