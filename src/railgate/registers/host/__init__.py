"""The host's side of the registers: buses, and a block's registers by name on any of them.

What drives a board (`odometer.device` and the like) takes a Bus, whichever it is, and is the same
on a serial line, in memory, and over a simulation.
"""

from railgate.registers.host.bus import AccessError, Bus, BusError, NoAnswerError, addresses
from railgate.registers.host.memory import MemoryBus
from railgate.registers.host.modelled import ModelledBus
from railgate.registers.host.registers import Registers
from railgate.registers.host.running import Running
from railgate.registers.host.simulated import SimulatedBus
from railgate.registers.host.uart import UartBus

__all__ = [
    "AccessError",
    "Bus",
    "BusError",
    "MemoryBus",
    "ModelledBus",
    "NoAnswerError",
    "Registers",
    "Running",
    "SimulatedBus",
    "UartBus",
    "addresses",
]
