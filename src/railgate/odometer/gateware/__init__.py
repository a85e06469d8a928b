"""The odometer's gateware: edges in, snapshots out. By its data flow:

inputs → steps, period, window, watch, stamps (each a file) → counters of one sensor (sensor) →
gate and snapshot of all sensors (odometer).
"""

from railgate.odometer.gateware.odometer import Odometer

__all__ = ["Odometer"]
