"""What a CPU reads and writes of FPGA 1 and of FPGA 2: the functions' blocks in one map (SYS-1)."""

from __future__ import annotations

from railgate.odometer.registers import registers as odometer
from railgate.position_link.registers import registers as position_link
from railgate.registers import Map
from railgate.unit.config import Unit
from railgate.vital_output.registers import registers as vital_output

__all__ = ["registers"]


def registers(unit: Unit, fpga: int) -> Map:
    """FPGA 1's, with the position link, or FPGA 2's. Raises ValueError."""
    if fpga not in (1, 2):
        raise ValueError(f"fpga must be 1 or 2, not {fpga}")
    blocks = [odometer(unit.odometer), vital_output(unit.vital)]
    if fpga == 1:
        blocks.append(position_link(unit.link))
    return Map.of(f"fpga_{fpga}", f"the on-board unit's FPGA {fpga}", blocks)
