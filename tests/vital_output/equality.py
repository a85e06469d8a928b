"""How the vital output's witnesses are held against one another."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

from railgate.engines import Design, Engine, open_engine
from railgate.waves import Trace

__all__ = ["assert_same", "opened"]


def assert_same(expected: Trace, found: Trace, *case: object) -> None:
    difference = expected.first_difference(found)
    assert difference is None, f"leap and the gateware part: {difference} {case}"


@cache
def _built(made: Callable[[], Design], kind: str) -> tuple[Engine, Any]:
    """A design in an engine that is built once, and its state at tick 0."""
    engine = open_engine(made(), kind)
    return engine, engine.checkpoint()


def opened(made: Callable[[], Design], kind: str) -> Engine:
    """The same at tick 0, from where nobody else runs it until it is opened again."""
    engine, start = _built(made, kind)
    engine.restore(start)
    return engine
