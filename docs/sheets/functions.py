"""The three functions as the makers know them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from amaranth.lib import wiring

from railgate.odometer import registers as odometer_registers
from railgate.odometer.gateware import Odometer
from railgate.odometer.spec import Config as OdometerConfig
from railgate.position_link import registers as link_registers
from railgate.position_link.gateware import PositionLink
from railgate.position_link.spec import Config as LinkConfig
from railgate.registers import Block
from railgate.vital_output import registers as vital_registers
from railgate.vital_output.gateware import Channel
from railgate.vital_output.spec import Config as VitalConfig

__all__ = ["FUNCTIONS", "Function", "function"]


@dataclass(frozen=True)
class Function:
    """config: its defaults. top: its gateware. registers: its block."""

    config: Any
    top: Callable[[Any], wiring.Component]
    registers: Callable[[Any], Block]


FUNCTIONS: Mapping[str, Function] = {
    "odometer": Function(OdometerConfig(), Odometer, odometer_registers.registers),
    "position_link": Function(LinkConfig(), PositionLink, link_registers.registers),
    "vital_output": Function(
        VitalConfig(), lambda config: Channel(config, 0), vital_registers.registers
    ),
}


def function(name: str) -> Function:
    """By its name. Raises ValueError."""
    if name not in FUNCTIONS:
        raise ValueError(f'a function must be one of {", ".join(FUNCTIONS)}, not "{name}"')
    return FUNCTIONS[name]
