"""A core for somebody else's design: what has registers, behind a bridge of the bus there."""

from railgate.fpga.export.gateware.bridged import Bridged

__all__ = ["Bridged"]
