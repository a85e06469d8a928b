"""How the position link's witnesses are held against one another."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cache
from typing import Any

from railgate.engines import Design, Engine, open_engine
from railgate.position_link.design import design
from railgate.position_link.spec import Config
from railgate.waves import Trace


def reset_spans(inputs: Trace) -> Iterable[tuple[int, int]]:
    """Of each stretch without reset its tick 0 and the first tick that is not its own."""
    rst = inputs.signals.get("rst")
    starts = [0] if rst is None or not rst.values[0] else []
    starts += [] if rst is None else rst.falling().tolist()
    stops = [] if rst is None else (rst.rising() + 1).tolist()
    return zip(starts, [*stops, inputs.end], strict=False)


def assert_fixed_phase(config: Config, inputs: Trace, found: Trace) -> None:
    """From the first delivery after a reset on there is one every cycle_ticks, and no other."""
    expected = [
        tick
        for start, stop in reset_spans(inputs)
        for tick in range(start + 1 + config.delivery_ticks, stop, config.cycle_ticks)
    ]
    assert found["delivery"].rising().tolist() == expected


def assert_same(expected: Trace, found: Trace, *case: object) -> None:
    difference = expected.first_difference(found)
    assert difference is None, f"leap and the gateware part: {difference} {case}"


@cache
def _built(of: Callable[[Config], Design], kind: str, config: Config) -> tuple[Engine, Any]:
    """A design in an engine that is built once, and its state at tick 0."""
    engine = open_engine(of(config), kind)
    return engine, engine.checkpoint()


def opened(of: Callable[[Config], Design], kind: str, config: Config) -> Engine:
    """The same at tick 0, from where nobody else runs it until it is opened again."""
    engine, start = _built(of, kind, config)
    engine.restore(start)
    return engine


def leap(config: Config, inputs: Trace) -> Trace:
    """What the model makes of its pins."""
    return open_engine(design(config), "leap").advance(inputs.end, inputs)


def gateware(config: Config, inputs: Trace, kind: str = "cxxrtl") -> Trace:
    """What the gateware makes of its pins."""
    return opened(design, kind, config).advance(inputs.end, inputs)
