"""What a core is driven with and what its model answers, as a text that a test bench reads.

A line is a change: the tick, the number of the signal, its value from then on in hex; lines are in
order of the ticks, and all signals are in tick 0. Signals have 64 bits at most: of a wider port
each 64 bits are one. What a port holds in tick k is read at the clock's edge after it, with which
tick k + 1 begins. The run begins with a part of itself, then a reset.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from railgate.engines import open_engine
from railgate.engines.ports import ports
from railgate.engines.signals import Port
from railgate.fpga.export.targets import Core
from railgate.waves import Trace, Waveform

__all__ = ["Vectors", "vectors"]

FIRST_TICKS = 1_000
"""Before the reset."""


@dataclass(frozen=True)
class Vectors:
    """signals: by number. trace: of each."""

    signals: tuple[Port, ...]
    trace: Trace

    def text(self) -> str:
        """All lines."""
        waves = [self.trace[port.name] for port in self.signals]
        ticks = np.concatenate([wave.ticks for wave in waves])
        numbers = np.repeat(np.arange(len(waves)), [wave.ticks.size for wave in waves])
        values = [
            value & (1 << port.width) - 1
            for port, wave in zip(self.signals, waves, strict=True)
            for value in wave.values.tolist()
        ]
        lines = (
            f"{ticks[at]} {numbers[at]} {int(values[at]):x}\n"
            for at in np.lexsort((numbers, ticks))
        )
        return "".join(lines)


def vectors(core: Core) -> Vectors:
    """Of a core whose function has a model: its inputs and, as leap has them, its outputs."""
    design, stimulus = core.design, core.stimulus
    if design is None or stimulus is None:
        raise ValueError(f"{core.name} must be one function to have vectors")
    inputs = _reset(stimulus())
    outputs = open_engine(design, "leap").advance(inputs.end, inputs)
    signals = ports(core.component, design.clocks)
    trace = inputs.merge(outputs)
    return Vectors(tuple(port for port in signals if port.name in trace.signals), trace)


def _reset(inputs: Trace) -> Trace:
    """After the first ticks the same from tick 0 on."""
    first = min(FIRST_TICKS, inputs.end)
    whole = inputs.slice(0, first).concatenate(inputs.shift(first))
    reset = Trace(
        {"rst": Waveform.of([0, first - 1, first], [0, 1, 0])}, whole.period, 0, whole.end
    )
    return whole.merge(reset)
