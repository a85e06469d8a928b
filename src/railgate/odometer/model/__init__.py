"""The odometer's model: the gateware's twin, from event to event.

pins → inputs → kernel (one sensor, compiled) → stamping (its FIFO) → snapshots;
model puts them together for all sensors.
"""

from railgate.odometer.model.model import Model

__all__ = ["Model"]
