"""The vital output's plant as Amaranth components, by the contract in railgate…plant.

`Plant` has all that answers within ticks: cross-link, relays, feedback.
"""

from railgate.vital_output.plant.gateware.line import Line
from railgate.vital_output.plant.gateware.plant import Plant
from railgate.vital_output.plant.gateware.relay import Relay

__all__ = ["Line", "Plant", "Relay"]
