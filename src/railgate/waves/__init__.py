"""Signals as step functions, and the files that hold them."""

from railgate.waves.trace import Difference, Trace
from railgate.waves.waveform import Waveform

__all__ = ["Difference", "Trace", "Waveform"]
