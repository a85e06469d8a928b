"""A board that is running, looked at through its registers: what is on it, and its live values."""

from railgate.attach.live import Live, on_port, on_simulation, readings
from railgate.attach.table import show

__all__ = ["Live", "on_port", "on_simulation", "readings", "show"]
