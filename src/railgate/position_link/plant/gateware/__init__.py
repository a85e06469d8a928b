"""The position link's plant as Amaranth components, by the contract in railgate…plant.

position system → line → (the link) → radio unit; `Plant` has all of them.
"""

from railgate.position_link.plant.gateware.line import Line
from railgate.position_link.plant.gateware.plant import Plant
from railgate.position_link.plant.gateware.radio import RadioUnit
from railgate.position_link.plant.gateware.system import PositionSystem

__all__ = ["Line", "Plant", "PositionSystem", "RadioUnit"]
