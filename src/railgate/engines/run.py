"""A whole stimulus through an engine, with progress."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from railgate.engines.design import Engine
from railgate.waves import Trace, Waveform

__all__ = ["run"]

PARTS = 100


def run(engine: Engine, stimulus: Trace, progress: Callable[[float], None] | None = None) -> Trace:
    """Advance from now to the stimulus' end; `progress` is told the part done after each step."""
    if progress is None:
        return engine.advance(stimulus.end, stimulus)
    bounds = np.linspace(engine.now, stimulus.end, PARTS + 1).astype(np.int64)
    pieces = []
    for start, until in pairwise(bounds.tolist()):
        if until > start:
            pieces.append(engine.advance(until, stimulus.slice(start, until)))
        progress((until - bounds[0]) / max(1, bounds[-1] - bounds[0]))
    return joined(pieces)


def joined(pieces: list[Trace]) -> Trace:
    """Traces that follow one another, as one."""
    first, last = pieces[0], pieces[-1]
    signals = {
        name: Waveform.of(
            np.concatenate([piece[name].ticks for piece in pieces]),
            np.concatenate([piece[name].values for piece in pieces]),
            wave.width,
            wave.signed,
        )
        for name, wave in first.signals.items()
    }
    return Trace(signals, first.period, first.start, last.end)
