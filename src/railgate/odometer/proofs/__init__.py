"""What is proven of the odometer's gateware.

The filter of its inputs (inputs); then, from the pins on: counts (pulses), ticks (periods),
position and direction (steps), the window and its sums (window), what is full (saturation); and how
all of it comes to the ports (snapshots, flags). All that is of sensor 0, and each other one is as
it would be alone (sensors). What these share of the contract, of pins, steps and strobes, is
written once more without the gateware (contract).
"""

from railgate.odometer.proofs import (
    flags,
    inputs,
    periods,
    pulses,
    saturation,
    sensors,
    snapshots,
    steps,
    window,
)
from railgate.proving import Claim

__all__ = ["CLAIMS"]

CLAIMS: tuple[Claim, ...] = (
    *inputs.CLAIMS,
    *pulses.CLAIMS,
    *periods.CLAIMS,
    *steps.CLAIMS,
    *window.CLAIMS,
    *saturation.CLAIMS,
    *snapshots.CLAIMS,
    *sensors.CLAIMS,
    *flags.CLAIMS,
)
