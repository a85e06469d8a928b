"""What is placed: every function in its default configuration, and what it is held against."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from amaranth.lib import wiring

from railgate.fpga.gateware import (
    Counter,
    Crc32,
    Lfsr,
    LiteEthMac,
    NaiveOdometer,
    Sources,
    Ssi,
    netlist,
)
from railgate.fpga.gateware.mac import verilog as liteeth_verilog
from railgate.odometer.gateware import Odometer
from railgate.odometer.spec import Config as OdometerConfig
from railgate.position_link.gateware import PositionLink
from railgate.position_link.spec import Config as LinkConfig
from railgate.vital_output.gateware import Channel
from railgate.vital_output.spec import Config as VitalConfig

__all__ = ["CEILING", "TARGETS", "Goal", "Target", "chosen"]


@dataclass(frozen=True)
class Goal:
    """On parts.REFERENCE: the clock to reach with the worst seed, and in the median, MHz; how many
    LUTs it may take for each of its peer's."""

    worst_mhz: float
    median_mhz: float | None = None
    lut_ratio: float | None = None


@dataclass(frozen=True)
class Target:
    """component: of domain sync alone. kind: ceiling, peer or function. goal: of a function. peer:
    the target that does the same, or none. verilog: of what the component instantiates."""

    component: Callable[[], wiring.Component]
    kind: str
    goal: Goal | None = None
    peer: str = ""
    verilog: Callable[[], str] = str

    def sources(self) -> Sources:
        """Of what is placed. Raises ValueError where they cannot be had."""
        return Sources(netlist(self.component()), self.verilog())


CEILING = "lfsr"
"""The target whose frequency is the practical ceiling of a part."""

TARGETS: Mapping[str, Target] = {
    CEILING: Target(Lfsr, "ceiling"),
    "counter": Target(Counter, "peer"),
    "ssi": Target(Ssi, "peer"),
    "crc32": Target(Crc32, "peer"),
    "liteeth": Target(LiteEthMac, "peer", verilog=liteeth_verilog),
    "position_link": Target(lambda: PositionLink(LinkConfig()), "function", Goal(280)),
    "naive_odometer": Target(lambda: NaiveOdometer(OdometerConfig(sensors=1)), "peer"),
    "odometer": Target(
        lambda: Odometer(OdometerConfig(sensors=1)),
        "function",
        Goal(280, 300, lut_ratio=1.3),
        peer="naive_odometer",
    ),
    "vital_output": Target(lambda: Channel(VitalConfig(outputs=16), 0), "function", Goal(150)),
}
"""By name, the small ones first."""


def chosen(names: Sequence[str]) -> dict[str, Target]:
    """The targets of these names, all without one, in the order of TARGETS. Raises ValueError."""
    for name in names:
        if name not in TARGETS:
            raise ValueError(f'a target must be one of {", ".join(TARGETS)}, not "{name}"')
    return {name: target for name, target in TARGETS.items() if name in (names or TARGETS)}
