"""A whole stimulus through an engine, with progress."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from railgate.engines.design import Engine
from railgate.waves import Trace

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
    return pieces[0].concatenate(*pieces[1:])
