"""Gateware that every function shares."""

from railgate.primitives.counter import ChunkedSum, LookaheadCounter
from railgate.primitives.divider import FractionalDivider
from railgate.primitives.hardened import SparseState, Twin
from railgate.primitives.inputs import FilteredInput
from railgate.primitives.receiver import SerialReceiver
from railgate.primitives.serial import SerialCheck, SerialTransmitter
from railgate.primitives.through import through
from railgate.primitives.timer import OneShot

__all__ = [
    "ChunkedSum",
    "FilteredInput",
    "FractionalDivider",
    "LookaheadCounter",
    "OneShot",
    "SerialCheck",
    "SerialReceiver",
    "SerialTransmitter",
    "SparseState",
    "Twin",
    "through",
]
