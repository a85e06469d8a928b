"""A piece of a real capture for the odometer."""

from __future__ import annotations

from fractions import Fraction
from functools import reduce
from importlib import resources

from railgate.odometer.measure import stimulus
from railgate.odometer.spec import Config
from railgate.waves import Trace, read

__all__ = ["wheel"]

CAPTURE = "wheel.vcd"
"""20 ms of two quadrature pairs: an optical sensor's, captured by the project sigrok
(sigrok-dumps, avago_adns_2051, public domain)."""
PAIRS = (("YA", "YB"), ("XA", "XB"))
"""The second one turns back."""
READS_S = Fraction(1, 500)
"""From snapshot to snapshot."""


def wheel(config: Config) -> Trace:
    """The odometer's inputs: its sensors have the capture's pairs in turn."""
    with resources.as_file(resources.files(__package__) / CAPTURE) as path:
        pins = read(path)
    return reduce(Trace.merge, (_sensor(config, pins, number) for number in range(config.sensors)))


def _sensor(config: Config, pins: Trace, number: int) -> Trace:
    a, b = PAIRS[number % len(PAIRS)]
    inputs = stimulus(pins.select((a, b)).rename({a: "a", b: "b"}), config, READS_S)
    if number == 0:
        return inputs
    own = [name for name in inputs.signals if name.startswith("sensor.0.")]
    return inputs.select(own).rename({name: name.replace("0", str(number), 1) for name in own})
