"""The on-board unit's two FPGAs, each its functions on one bus."""

from railgate.unit.gateware.fpga import LINK_DOMAIN, Fpga

__all__ = ["LINK_DOMAIN", "Fpga"]
