"""What can be exported: each function, and each FPGA of the on-board unit."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railgate.engines import Design
from railgate.fpga.export.buses import BUSES, NONE
from railgate.fpga.export.configuration import read_configuration
from railgate.fpga.export.gateware import Bridged
from railgate.fpga.export.stimuli import channel, link, wheel
from railgate.odometer import design as odometer
from railgate.odometer.gateware import Odometer
from railgate.odometer.registers import registers as odometer_registers
from railgate.odometer.spec import Config as OdometerConfig
from railgate.position_link import design as position_link
from railgate.position_link.gateware import PositionLink
from railgate.position_link.registers import registers as link_registers
from railgate.position_link.spec import Config as LinkConfig
from railgate.registers import Block, Map
from railgate.registers.gateware import Mapped, address_bits
from railgate.unit.config import UNITS, Unit
from railgate.unit.gateware import LINK_DOMAIN, Fpga
from railgate.unit.registers import registers as unit_registers
from railgate.vital_output import design as vital_output
from railgate.vital_output.gateware import Channel
from railgate.vital_output.registers import registers as vital_registers
from railgate.vital_output.spec import Config as VitalConfig
from railgate.waves import Trace

if TYPE_CHECKING:
    from _typeshed import DataclassInstance
    from amaranth.lib import wiring

__all__ = ["TARGETS", "UNIT", "Core", "core"]

UNIT = "unit"
SYNC = "sync"


@dataclass(frozen=True, kw_only=True)
class Core:
    """What is exported.

    name: of its module and files. title: in a few words. made: makes the component. contract: whose
    docstrings tell of its ports. hz: of each domain's clock. configurations: by function. map: of
    its registers. bus: they are on, or NONE. design, stimulus: a function with its model, and what
    it is driven with; None of the unit's FPGAs.
    """

    name: str
    title: str
    made: Callable[[], wiring.Component]
    contract: tuple[type[wiring.Component], ...]
    hz: Mapping[str, int]
    configurations: Mapping[str, DataclassInstance]
    map: Map
    bus: str
    design: Design | None = None
    stimulus: Callable[[], Trace] | None = None

    @cached_property
    def component(self) -> wiring.Component:
        """With all that is on its ports; made when it is needed."""
        return self.made()

    @property
    def still(self) -> tuple[str, ...]:
        """See Bus."""
        return () if self.bus == NONE else BUSES[self.bus].still


@dataclass(frozen=True)
class Function:
    """configured: its configuration in a unit. design, stimulus: for a configuration and the FPGA
    that it is on."""

    title: str
    gateware: type[wiring.Component]
    kind: type[DataclassInstance]
    configured: Callable[[Unit], Any]
    design: Callable[[Any, int], Design]
    registers: Callable[[Any], Block]
    stimulus: Callable[[Any, int], Trace]
    paired: bool = False


FUNCTIONS: Mapping[str, Function] = {
    "odometer": Function(
        "period, phase, pulses and position of two-channel wheel sensors",
        Odometer,
        OdometerConfig,
        lambda unit: unit.odometer,
        lambda config, _: odometer.design(config),
        odometer_registers,
        lambda config, _: wheel(config),
    ),
    "position_link": Function(
        "asks a position system for its word and delivers it to a radio unit",
        PositionLink,
        LinkConfig,
        lambda unit: unit.link,
        lambda config, _: position_link.design(config),
        link_registers,
        lambda config, _: link(config),
    ),
    "vital_output": Function(
        "one channel of two that vote commands and drive a relay together",
        Channel,
        VitalConfig,
        lambda unit: unit.vital,
        lambda config, fpga: vital_output.design(config, fpga - 1),
        vital_registers,
        lambda config, fpga: channel(config, fpga - 1),
        paired=True,
    ),
}

TARGETS = (*FUNCTIONS, UNIT)


def core(target: str, *, config: str | None = None, bus: str = NONE, fpga: int = 1) -> Core:
    """One of TARGETS. config: a unit's name, or of a function a TOML file; None: the defaults. bus:
    one of BUSES, or NONE. fpga: 1 or 2, the channel of the vital output, the FPGA of the unit.
    Raises ValueError."""
    for what, given, allowed in (
        ("a target", target, TARGETS),
        ("bus", bus, (NONE, *BUSES)),
    ):
        if given not in allowed:
            raise ValueError(f'{what} must be one of {", ".join(allowed)}, not "{given}"')
    if fpga not in (1, 2):
        raise ValueError(f"fpga must be 1 or 2, not {fpga}")
    if target == UNIT:
        return _unit(config or next(iter(UNITS)), bus, fpga)
    function = FUNCTIONS[target]
    settings = _settings(function, config)
    design = function.design(settings, fpga)
    block = function.registers(settings)
    name = f"{target}_{fpga}" if function.paired else target
    clock_hz: int = settings.clock_hz

    def made() -> wiring.Component:
        bare = design.component()
        return bare if bus == NONE else _bridged(bus, clock_hz, Mapped(bare, block), block.size)

    return Core(
        name=_name(name, bus),
        title=function.title,
        made=made,
        contract=_contract(function.gateware, bus),
        hz={SYNC: clock_hz},
        configurations={target: settings},
        map=Map.of(target, block.description, [block]),
        bus=bus,
        design=design,
        stimulus=partial(function.stimulus, settings, fpga),
    )


def _unit(config: str, bus: str, fpga: int) -> Core:
    if config not in UNITS:
        raise ValueError(f'config must be one of {", ".join(UNITS)} for the unit, not "{config}"')
    unit = UNITS[config]()
    map_ = unit_registers(unit, fpga)
    clock_hz = unit.odometer.clock_hz
    settings: dict[str, DataclassInstance] = {"odometer": unit.odometer, "vital_output": unit.vital}
    hz = {SYNC: clock_hz}
    if fpga == 1:
        settings["position_link"], hz[LINK_DOMAIN] = unit.link, unit.link.clock_hz

    def made() -> wiring.Component:
        bare = Fpga(unit, fpga)
        return bare if bus == NONE else _bridged(bus, clock_hz, bare, map_.size)

    return Core(
        name=_name(f"fpga_{fpga}", bus),
        title=map_.description,
        made=made,
        contract=_contract(Fpga, bus),
        hz=hz,
        configurations=settings,
        map=map_,
        bus=bus,
    )


def _settings(function: Function, config: str | None) -> Any:
    if config is None:
        return function.kind()
    if config in UNITS:
        return function.configured(UNITS[config]())
    return read_configuration(function.kind, Path(config))


def _bridged(bus: str, clock_hz: int, served: wiring.Component, size: int) -> wiring.Component:
    return Bridged(served, BUSES[bus].bridge(address_bits(size), clock_hz))


def _contract(gateware: type[wiring.Component], bus: str) -> tuple[type[wiring.Component], ...]:
    return (gateware,) if bus == NONE else (gateware, BUSES[bus].kind)


def _name(name: str, bus: str) -> str:
    return f"railgate_{name}" + ("" if bus == NONE else f"_{bus.replace('-', '_')}")
