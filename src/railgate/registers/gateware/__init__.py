"""Registers on a bus: from pins to banks.

A bridge (uart, axi, wishbone, local_bus) turns what the outside world speaks into requests on
one internal bus (bus); a decoder hands them to the blocks, a crossing to another clock; a bank
(access, sticky) answers them from its function's ports, and mapped joins the two.
"""

from railgate.registers.gateware.axi import AxiLite, axi_signature
from railgate.registers.gateware.bank import Bank
from railgate.registers.gateware.bus import address_bits, bus_signature
from railgate.registers.gateware.crossing import BusCrossing
from railgate.registers.gateware.decoder import Decoder
from railgate.registers.gateware.local_bus import LocalBus
from railgate.registers.gateware.mapped import Mapped
from railgate.registers.gateware.uart import Uart
from railgate.registers.gateware.wishbone import Wishbone, wishbone_signature

__all__ = [
    "AxiLite",
    "Bank",
    "BusCrossing",
    "Decoder",
    "LocalBus",
    "Mapped",
    "Uart",
    "Wishbone",
    "address_bits",
    "axi_signature",
    "bus_signature",
    "wishbone_signature",
]
