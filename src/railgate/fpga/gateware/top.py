"""What is built for a board: a target's functions on one bus, with the bridge to a serial line.

uart ◄─► bridge ── bus ── functions ◄─► sensor_1, sensor_2, link, channel
channel.cpu_rx ► commands, time ──┘
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from amaranth.hdl import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.fpga.gateware.cpu_line import CpuLine
from railgate.odometer.gateware import Odometer
from railgate.odometer.registers import registers as odometer
from railgate.position_link.gateware import PositionLink
from railgate.position_link.registers import registers as position_link
from railgate.primitives import through
from railgate.registers import Block, Map
from railgate.registers.gateware import Mapped, address_bits
from railgate.registers.gateware.uart import BAUD, Uart
from railgate.unit.config import AXLES, Unit
from railgate.unit.gateware import LINK_DOMAIN, Fpga
from railgate.unit.registers import registers
from railgate.vital_output.gateware import Channel
from railgate.vital_output.registers import registers as vital_output

__all__ = ["PINS", "TARGETS", "Top"]

PINS: Mapping[str, tuple[str, ...]] = {
    "uart": ("rx", "tx"),
    **{f"sensor_{axle}": ("a", "b") for axle in range(1, AXLES + 1)},
    "link": ("clk", "anf", "uef", "data", "radio_valid", "radio_data"),
    "channel": ("cpu_rx", "link_rx", "link_tx", "pulses", "pulse_feedback", "contact"),
}
"""The members that a top can have, and theirs."""

ALONE: Mapping[str, tuple[Callable[[Any], wiring.Component], Callable[[Any], Block]]] = {
    "odometer": (Odometer, odometer),
    "position_link": (PositionLink, position_link),
    "vital_output": (lambda config: Channel(config, 0), vital_output),
}
"""A function of FPGA 1 by itself: its gateware and its registers."""
WHOLE = {"fpga_1": 1, "fpga_2": 2}
"""An FPGA of the unit."""

TARGETS = (*ALONE, *WHOLE)
"""What can be built, by name."""


class Top(wiring.Component):
    """A target of a unit, as it is on a board. Raises ValueError for a name that is none.

    Clock domain sync, with LINK_DOMAIN where both others and a position link are on it; their
    frequencies, Hz, are in `clocks`. map: what is on the bus. configurations: of its functions.
    Its members, see PINS, are pins, the inputs asynchronous. uart: rx: in, tx: out, 1 bit, with
    BAUD. Of the functions that it has: sensor_1, sensor_2: in, of the odometer's sensors. link,
    channel: the ports of PositionLink and of Channel; cpu_rx: in, 1 bit, see CpuLine.
    Requirements SYS-1, SYS-5.
    """

    def __init__(self, unit: Unit, target: str) -> None:
        if target not in TARGETS:
            raise ValueError(f'a target must be one of {", ".join(TARGETS)}, not "{target}"')
        configurations: dict[str, Any] = {
            "odometer": unit.odometer,
            "position_link": unit.link,
            "vital_output": unit.vital,
        }
        if target in ALONE:
            function, block = (make(configurations[target]) for make in ALONE[target])
            self.map = Map.of(target, block.description, [block])
            self._inside = Mapped(function, block)
        else:
            self.map = registers(unit, WHOLE[target])
            self._inside = Fpga(unit, WHOLE[target])
        there = [block.name for block in self.map.blocks.values()]
        self.configurations = {name: configurations[name] for name in there}
        self.clocks = {"sync": configurations[there[0]].clock_hz}
        if target in WHOLE and "position_link" in there:
            self.clocks[LINK_DOMAIN] = unit.link.clock_hz
        self._served: dict[str, Any] = {}
        if "odometer" in there:
            sensors = enumerate(self._inside.sensor, 1)
            self._served |= {f"sensor_{axle}": sensor for axle, sensor in sensors}
        for name, function in (("link", "position_link"), ("channel", "vital_output")):
            if function in there:
                self._served[name] = getattr(self._inside, name, self._inside)
        members = {"uart": {"rx": In(1), "tx": Out(1, init=1)}}
        for name, served in self._served.items():
            its = served.signature.members
            members[name] = {pin: its[pin] for pin in PINS[name] if pin in its}
        if "channel" in self._served:
            members["channel"]["cpu_rx"] = In(1)
            channel = self._served["channel"].signature
            self._line = CpuLine(unit.vital, channel, self.bit_ticks)
        super().__init__({name: Out(wiring.Signature(pins)) for name, pins in members.items()})

    @property
    def bit_ticks(self) -> int:
        """Of the serial lines."""
        return round(self.clocks["sync"] / BAUD)

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.submodules.functions = inside = self._inside
        m.submodules.bridge = bridge = Uart(address_bits(self.map.size), self.bit_ticks)
        wiring.connect(m, bridge.bus, inside.bus)
        m.d.comb += [bridge.rx.eq(self.uart.rx), self.uart.tx.eq(bridge.tx)]
        for name, served in self._served.items():
            through(m, getattr(self, name), served, PINS[name])
        if channel := self._served.get("channel"):
            m.submodules.cpu_line = line = self._line
            m.d.comb += [line.rx.eq(self.channel.cpu_rx), channel.boot.eq(line.boot)]
            wiring.connect(m, line.command, channel.command)
            wiring.connect(m, line.time, channel.time)
        return m
