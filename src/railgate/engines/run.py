"""A whole stimulus through an engine, with progress."""

from __future__ import annotations

from collections.abc import Callable

from railgate.engines.design import Engine
from railgate.waves import Trace

__all__ = ["run"]

PARTS = 100


def run(engine: Engine, stimulus: Trace, progress: Callable[[float], None] | None = None) -> Trace:
    """Advance from now to the stimulus' end; `progress` is told the part done after each step."""
    if progress is None:
        return engine.advance(stimulus.end, stimulus)
    start, span = engine.now, stimulus.end - engine.now
    pieces = []
    for until in sorted({start + span * i // PARTS for i in range(1, PARTS + 1)}):
        if until > engine.now or not span:
            pieces.append(engine.advance(until, stimulus))
            progress((until - start) / span if span else 1.0)
    return pieces[0].concatenate(*pieces[1:])
