"""Functions as cores for somebody else's design (SYS-3)."""

from railgate.fpga.export.buses import BUSES, NONE
from railgate.fpga.export.files import FORMATS, export
from railgate.fpga.export.targets import TARGETS, core

__all__ = ["BUSES", "FORMATS", "NONE", "TARGETS", "core", "export"]
