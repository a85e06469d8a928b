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

from railgate.fpga.gateware.cpu_line import FED, CpuLine
from railgate.odometer.gateware import Odometer
from railgate.odometer.registers import registers as odometer
from railgate.position_link.gateware import PositionLink
from railgate.position_link.registers import registers as position_link
from railgate.registers import Block, Map
from railgate.registers.gateware import Mapped, address_bits
from railgate.registers.gateware.uart import Uart
from railgate.unit.config import Unit
from railgate.unit.gateware import LINK_DOMAIN, Fpga
from railgate.unit.registers import registers
from railgate.vital_output.gateware import Channel
from railgate.vital_output.registers import registers as vital_output

__all__ = ["BAUD", "WHOLE", "Top", "target_names"]

BAUD = 115_200

LINK = ("clk", "anf", "uef", "data", "radio_valid", "radio_data")
CHANNEL = ("link_rx", "link_tx", "pulses", "pulse_feedback", "contact")
SENSOR = ("a", "b")

ALONE: Mapping[str, tuple[Callable[[Any], wiring.Component], Callable[[Any], Block]]] = {
    "odometer": (Odometer, odometer),
    "position_link": (PositionLink, position_link),
    "vital_output": (lambda config: Channel(config, 0), vital_output),
}
"""A function of FPGA 1 by itself: its gateware and its registers."""
WHOLE = {"fpga_1": 1, "fpga_2": 2}
"""An FPGA of the unit."""


def target_names() -> tuple[str, ...]:
    """Of what can be built."""
    return (*ALONE, *WHOLE)


class Top(wiring.Component):
    """A target of a unit, as it is on a board. Raises ValueError for a name that is none.

    Clock domain sync, with LINK_DOMAIN where both others and a position link are on it; their
    frequencies, Hz, are in `clocks`. map: what is on the bus. configurations: of its functions. All members are pins; asynchronous,
    if inputs. uart: rx: in, tx: out, 1 bit, of BAUD. Those of the target's functions: sensor_1,
    sensor_2: a, b: in, 1 bit. link: the ports of PositionLink of these names. channel: those of
    Channel; cpu_rx: in, 1 bit, see CpuLine. Requirements SYS-1, SYS-5.
    """

    def __init__(self, unit: Unit, target: str) -> None:
        if target not in target_names():
            raise ValueError(f'a target must be one of {", ".join(target_names())}, not "{target}"')
        self._unit = unit
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
        self._link, self._channel = (
            getattr(self._inside, name, self._inside) if function in there else None
            for name, function in (("link", "position_link"), ("channel", "vital_output"))
        )
        members = {"uart": Out(wiring.Signature({"rx": In(1), "tx": Out(1, init=1)}))}
        if "odometer" in there:
            for n, sensor in enumerate(self._inside.sensor, 1):
                members[f"sensor_{n}"] = Out(_members(sensor, SENSOR))
        if self._link:
            members["link"] = Out(_members(self._link, LINK))
        if self._channel:
            pins = _members(self._channel, CHANNEL).members
            members["channel"] = Out(wiring.Signature({"cpu_rx": In(1), **pins}))
        super().__init__(members)

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
        for n, sensor in enumerate(getattr(inside, "sensor", ()), 1):
            _through(m, getattr(self, f"sensor_{n}"), sensor, SENSOR)
        if self._link:
            _through(m, self.link, self._link, LINK)
        if self._channel:
            _through(m, self.channel, self._channel, CHANNEL)
            m.submodules.cpu_line = line = CpuLine(self._unit.vital, self.bit_ticks)
            m.d.comb += line.rx.eq(self.channel.cpu_rx)
            wiring.connect(m, line.command, self._channel.command)
            wiring.connect(m, line.time, self._channel.time)
            m.d.comb += self._channel.boot.eq(line.boot)
        return m


def _members(inside: wiring.PureInterface, names: tuple[str, ...]) -> wiring.Signature:
    """These of it."""
    return wiring.Signature({name: inside.signature.members[name] for name in names})


def _through(
    m: Module, outside: wiring.PureInterface, inside: wiring.PureInterface, names: tuple[str, ...]
) -> None:
    """These members of the inside are the outside's."""
    for name in names:
        inner, outer = getattr(inside, name), getattr(outside, name)
        given = outside.signature.members[name].flow == Out
        m.d.comb += outer.eq(inner) if given else inner.eq(outer)
