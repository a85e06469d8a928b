"""A piece of a real capture for the odometer, then all that a sensor must never do."""

from __future__ import annotations

from fractions import Fraction
from functools import reduce
from importlib import resources
from itertools import accumulate
from random import Random

from railgate.odometer.measure import stimulus
from railgate.odometer.spec import Config
from railgate.waves import Trace, Waveform, read

__all__ = ["wheel"]

CAPTURE = "wheel.vcd"
"""20 ms of two quadrature pairs: an optical sensor's, captured by the project sigrok
(sigrok-dumps, avago_adns_2051, public domain)."""
PAIRS = (("YA", "YB"), ("XA", "XB"))
"""The second one turns back."""
READS_S = Fraction(1, 500)
"""From snapshot to snapshot."""

FORWARD = (0b01, 0b11, 0b10, 0b00)
"""The levels of a and b, as bits 0 and 1."""
STORM: tuple[tuple[int, tuple[int, ...], int], ...] = (
    (400, FORWARD, 8),  # far too fast
    (4_000, FORWARD[::-1], 2),  # back
    (2_000, (0b01, 0b00), 12),  # without b
    (2_000, (0b10, 0b00), 12),  # without a
    (3_000, (0b11, 0b00), 4),  # both at once
    (200, (0b01, 0b11, 0b11, 0b11, 0b11, 0b11, 0b11, 0b10, 0b00), 8),  # in a wrong phase
)
"""How many ticks each level lasts, the levels of a turn, how many of these."""
RANDOM_EDGES = 200


def wheel(config: Config) -> Trace:
    """The odometer's inputs: its sensors have the capture's pairs in turn."""
    with resources.as_file(resources.files(__package__) / CAPTURE) as path:
        pins = read(path)
    return reduce(Trace.merge, (_sensor(config, pins, number) for number in range(config.sensors)))


def _sensor(config: Config, pins: Trace, number: int) -> Trace:
    a, b = PAIRS[number % len(PAIRS)]
    captured = pins.select((a, b)).rename({a: "a", b: "b"}).resample(Fraction(1, config.clock_hz))
    inputs = stimulus(captured.concatenate(_storm(captured, number)), config, READS_S)
    if number == 0:
        return inputs
    own = [name for name in inputs.signals if name.startswith("sensor.0.")]
    return inputs.select(own).rename({name: name.replace("0", str(number), 1) for name in own})


def _storm(before: Trace, seed: int) -> Trace:
    """STORM, then edges at random."""
    when, what = Random(0), Random(seed)  # all storms are of the same length
    levels = [(lasts, level) for lasts, turn, times in STORM for level in turn * times]
    levels += [(when.randrange(1, 2_000), what.randrange(4)) for _ in range(RANDOM_EDGES)]
    start, *ticks = accumulate((lasts for lasts, _ in levels), initial=before.end)
    begins = [start, *ticks[:-1]]
    pins = {
        name: Waveform.of(begins, [level >> bit & 1 for _, level in levels])
        for bit, name in enumerate("ab")
    }
    return Trace(pins, before.period, before.end, ticks[-1])
