"""The three functions as they run under a bus: alone, and with their gateware's bank."""

from fractions import Fraction
from functools import cache

import numpy as np

from position_link.plant.stimuli import SMALL as SMALL_LINK
from railgate.engines import Design
from railgate.odometer.design import design as odometer_design
from railgate.odometer.gateware import Odometer
from railgate.odometer.plant import Sensor, course
from railgate.odometer.registers import registers as odometer
from railgate.odometer.spec import Config as OdometerConfig
from railgate.position_link.design import design as link_design
from railgate.position_link.gateware import PositionLink
from railgate.position_link.plant import Scenario, fault
from railgate.position_link.registers import registers as position_link
from railgate.position_link.spec import EVEN
from railgate.position_link.spec import Config as LinkConfig
from railgate.registers import Block
from railgate.registers.gateware import Mapped
from railgate.vital_output.design import design as vital_design
from railgate.vital_output.gateware import Channel
from railgate.vital_output.registers import registers as vital_output
from railgate.waves import Trace
from vital_output.small import SMALL

ODOMETER = OdometerConfig(clock_hz=100_000, overspeed_kmh=Fraction(300))
LINK = LinkConfig(**SMALL_LINK, check=EVEN)
CHANNEL = SMALL
CYCLES = 12


@cache
def wheels() -> Trace:
    """Both sensors of a train of 200 km/h, the second one half a second behind."""
    drive = Sensor().drive(course("constant", 200, 1), ODOMETER)
    signals = {f"sensor.{n}.{name}": w for n in range(2) for name, w in drive.signals.items()}
    return Trace(signals, drive.period, 0, drive.end)


@cache
def line() -> Trace:
    """A position system with two faults among its answers."""
    faults = tuple(fault(text) for text in ("bit-error@1.7ms", "missing@4.1ms"))
    counted = [n << 1 | n.bit_count() & 1 for n in range(CYCLES)]
    words = np.array(counted, np.uint64)
    return Scenario(words=words, faults=faults).plan(LINK, CYCLES).drive()


def mapped(function: str) -> tuple[Design, Block]:
    """A function with its bank."""
    alone, block = ALONE[function]
    made = {
        "odometer": lambda: Odometer(ODOMETER),
        "position_link": lambda: PositionLink(LINK),
        "vital_output": lambda: Channel(CHANNEL, 0),
    }[function]
    design = Design(
        name=f"mapped-{function}", component=lambda: Mapped(made(), block), clocks=alone.clocks
    )
    return design, block


ALONE: dict[str, tuple[Design, Block]] = {
    "odometer": (odometer_design(ODOMETER), odometer(ODOMETER)),
    "position_link": (link_design(LINK), position_link(LINK)),
    "vital_output": (vital_design(CHANNEL), vital_output(CHANNEL)),
}
"""A function, its model too, and its registers."""

PINS = {"odometer": wheels, "position_link": line}
