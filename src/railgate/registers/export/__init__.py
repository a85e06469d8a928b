"""What is made of the map for others: SystemRDL, and of that C header and HTML pages (SYS-1)."""

from railgate.registers.export.peakrdl import c_header, html
from railgate.registers.export.systemrdl import systemrdl
from railgate.registers.export.table import rows, show

__all__ = ["c_header", "html", "rows", "show", "systemrdl"]
