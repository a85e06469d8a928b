"""Signals as step functions, and the files that hold them."""

from railgate.waves.files import read
from railgate.waves.limits import Limits
from railgate.waves.parquet import write_parquet
from railgate.waves.replacing import replacing
from railgate.waves.trace import Difference, Trace
from railgate.waves.vcd import write_gtkw, write_vcd
from railgate.waves.waveform import Waveform

__all__ = [
    "Difference",
    "Limits",
    "Trace",
    "Waveform",
    "read",
    "replacing",
    "write_gtkw",
    "write_parquet",
    "write_vcd",
]
