"""What functions are placed behind, and beside; none of it is part of a function."""

from railgate.fpga.gateware.mac import LiteEthMac
from railgate.fpga.gateware.naive import NaiveOdometer
from railgate.fpga.gateware.peers import Counter, Crc32, Lfsr, Ssi
from railgate.fpga.gateware.pins import netlist
from railgate.fpga.gateware.sources import Sources

__all__ = ["Counter", "Crc32", "Lfsr", "LiteEthMac", "NaiveOdometer", "Sources", "Ssi", "netlist"]
