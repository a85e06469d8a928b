"""Evidence of the command frame's CRC: what it detects, how likely an error passes (DRV-2, DRV-4).

linear, few and spectrum know only linear codes; carriage knows where the frame lies on Ethernet and
in the cross-link's message; evidence gathers, table, picture and record show.
"""

from railgate.vital_output.residual.carriage import ETHERNET
from railgate.vital_output.residual.evidence import Comparison, compare
from railgate.vital_output.residual.table import show

__all__ = ["ETHERNET", "Comparison", "compare", "show"]
