"""A reading as a person reads it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from rich.table import Table

__all__ = ["show"]

Told = Mapping[str, Any]
Rows = Iterator[tuple[str, str]]


def show(reading: Sequence[Told]) -> Table:
    """All functions of a reading, one below the other."""
    table = Table(show_header=False, box=None, pad_edge=False)
    for told in reading:
        table.add_row(f"[bold]{told['function']}[/bold]", f"at {told['address']:#x}")
        for name, value in ROWS[told["function"]](told):
            table.add_row(f"  {name}", value)
    return table


def _odometer(told: Told) -> Rows:
    train = told["train"]
    yield "snapshot", f"{told['number']}, {told['time_s']:.3f} s after reset"
    yield "train", "stands" if train["standstill"] else _speed(train)
    low, high = (_number(train[f"distance_{end}_m"], 1) for end in ("low", "high"))
    yield "distance", f"{train['distance_m']:.1f} m, guaranteed {low} … {high} m"
    for n, axle in enumerate(told["axles"], 1):
        parts = [_speed(axle), axle["direction"], f"{axle['pulses']} pulses"]
        parts += [f"{axle['position_m']:.1f} m", axle["verdict"], *_odd(axle["flags"])]
        yield f"axle {n}", ", ".join(parts)


def _link(told: Told) -> Rows:
    if not told["number"]:
        yield "delivery", "none yet"
        return
    age = "" if told["age_s"] is None else f", {1e3 * told['age_s']:.1f} ms old"
    yield "delivery", f"{told['number']}, {told['status']}{age}"
    yield "health", ", ".join([told["health"], *_odd(told["causes"])])
    if not told["consistent"]:
        yield "fields", "[red]contradict one another[/red]"
    yield "word", told["word"]
    for name, value in told["values"].items():
        yield f"  {name}", f"{value:.6g}"
    yield "seen", ", ".join(_odd(told["seen"])) or "no cause"


def _channel(told: Told) -> Rows:
    flags = ("trusted", "linked", "drifting", "latched")
    yield "channel", ", ".join(name if told[name] else f"not {name}" for name in flags)
    yield "cycle", f"index {told['index']}, sequence {told['sequence']}, life {told['life']}"
    yield "image", f"{told['image']:#x}, blocked {told['blocked']:#x}, test {told['test_phase']}"
    yield "outputs", ", ".join(f"{n} {state}" for n, state in enumerate(told["states"]))
    votes = ("accepted", "start", "lost", "passed", "stored")
    yield "votes", ", ".join(f"{told[name]} {name}" for name in votes)
    counted = [f"{count} {name}" for name, count in told["causes"].items()]
    yield "causes", ", ".join(_odd(counted)) or "none"
    if told["first_cause"] != "none":
        alarm = told["first_cause"].endswith("alarm")
        output = f", output {told['first_output']}" if alarm else ""
        yield "first cause", told["first_cause"] + output
    yield "seen", ", ".join(_odd(told["seen"])) or "no cause"


ROWS = {"odometer": _odometer, "position_link": _link, "vital_output": _channel}


def _speed(told: Told) -> str:
    """A speed with its guaranteed interval, which holds without a speed too."""
    low, high = (_number(told[f"speed_{end}_kmh"], 2) for end in ("low", "high"))
    value = "no speed" if told["speed_kmh"] is None else f"{told['speed_kmh']:.2f}"
    return f"{value} km/h in {low} … {high}"


def _number(value: float | None, places: int) -> str:
    return "∞" if value is None else f"{value:.{places}f}"


def _odd(names: Sequence[str]) -> list[str]:
    """What a person should look at."""
    return [f"[yellow]{name}[/yellow]" for name in names]
