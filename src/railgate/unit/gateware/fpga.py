"""One FPGA of the unit: its functions, each with its registers, on one bus.

    sensors' pins ──────► odometer ──────────────┐
    CLK, ANF ◄─ UEF, DATA ► position link ───────┼─ decoder ── bus ──► a bridge, the CPU
    radio unit ◄──────────────┘ (FPGA 1 only)    │
    frames, time ───────► vital output, channel ─┘
    cross-link ◄────────►     └─► pulse trains ──► relays ──► feedback

The position link has a clock of its own, and a crossing to the bus.
"""

from __future__ import annotations

from amaranth.hdl import DomainRenamer, Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.odometer.gateware import Odometer
from railgate.position_link.gateware import PositionLink
from railgate.primitives import through
from railgate.registers.gateware import BusCrossing, Decoder, Mapped, address_bits, bus_signature
from railgate.unit.config import AXLES, Unit
from railgate.unit.registers import registers
from railgate.vital_output.gateware import Channel

__all__ = ["LINK_DOMAIN", "Fpga"]

LINK_DOMAIN = "link"
"""The domain of the position link's 40 MHz; all else is in sync, of 16 MHz."""

LINK_PINS = ("clk", "anf", "uef", "data", "radio_valid", "radio_data")
CHANNEL_PINS = (
    *("command", "time", "boot", "link_rx", "link_tx"),
    *("pulses", "pulse_feedback", "contact"),
)


class Fpga(wiring.Component):
    """FPGA 1 or 2 of a unit, without the bridge to its CPU.

    bus: in, see bus_signature, of domain sync, with the addresses of unit.registers. strobe: in, 1
    bit, the common one of all odometers. sensor: an interface for each axle, a, b: in, 1 bit, pins.
    link: FPGA 1's, the pins of PositionLink of these names, in domain LINK_DOMAIN. channel: the
    ports of Channel of these names. Requirements SYS-1, SYS-5.
    """

    def __init__(self, unit: Unit, fpga: int) -> None:
        self._map = registers(unit, fpga)
        blocks = {block.name: block for block in self._map.blocks.values()}
        self._odometer = Mapped(Odometer(unit.odometer), blocks["odometer"])
        self._channel = Mapped(Channel(unit.vital, fpga - 1), blocks["vital_output"])
        self._link = Mapped(PositionLink(unit.link), blocks["position_link"]) if fpga == 1 else None
        sensor = wiring.Signature({"a": In(1), "b": In(1)})
        members = {
            "bus": In(bus_signature(address_bits(self._map.size))),
            "strobe": In(1),
            "sensor": Out(sensor).array(AXLES),
            "channel": Out(_pins(self._channel, CHANNEL_PINS)),
        }
        if self._link:
            members["link"] = Out(_pins(self._link, LINK_PINS))
        super().__init__(members)

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.submodules.decoder = decoder = Decoder(self._map)
        m.submodules.odometer = odometer = self._odometer
        m.submodules.channel = channel = self._channel
        wiring.connect(m, wiring.flipped(self.bus), decoder.bus)
        wiring.connect(m, decoder.served.odometer, odometer.bus)
        wiring.connect(m, decoder.served.vital_output, channel.bus)
        through(m, self, odometer, ("strobe",))
        for pins, sensor in zip(self.sensor, odometer.sensor, strict=True):
            through(m, pins, sensor, ("a", "b"))
        through(m, self.channel, channel, CHANNEL_PINS)
        if self._link:
            served = decoder.served.position_link
            bits = len(served.request.p.address)
            m.submodules.crossing = crossing = BusCrossing(bits, "sync", LINK_DOMAIN)
            m.submodules.link = link = DomainRenamer(LINK_DOMAIN)(self._link)
            wiring.connect(m, served, crossing.bus)
            wiring.connect(m, crossing.served, link.bus)
            through(m, self.link, link, LINK_PINS)
        return m


def _pins(function: wiring.Component, names: tuple[str, ...]) -> wiring.Signature:
    """These members of a function."""
    return wiring.Signature({name: function.signature.members[name] for name in names})
