"""Scenarios from TOML files, as those in `scenarios` beside this module are."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from decimal import Decimal
from fractions import Fraction
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from railgate.odometer.plant import Sensor
from railgate.toml_file import MisplacedError, parse_toml, read_text
from railgate.unit.application import Rule
from railgate.unit.faults import Fault
from railgate.unit.route import Route, Side, Stop
from railgate.unit.scenario import Scenario
from railgate.vital_output.plant import RelayTimes

__all__ = ["builtin", "builtins", "parse_scenario", "read_scenario"]

Reader = Callable[[object], Any]
"""Makes of what the file says of a key what a scenario needs. Raises ValueError."""


def builtins() -> tuple[str, ...]:
    """The names of those that are built in."""
    folder = resources.files(__package__).joinpath("scenarios")
    return tuple(sorted(f.name.removesuffix(".toml") for f in folder.iterdir()))


def builtin(name: str) -> Scenario:
    """A built-in scenario. Raises ValueError."""
    if name not in builtins():
        raise ValueError(
            f'a scenario must be a file or one of {", ".join(builtins())}, not "{name}"'
        )
    file = resources.files(__package__).joinpath("scenarios", f"{name}.toml")
    return parse_scenario(file.read_text("utf-8"), f"{name}.toml")


def read_scenario(path: str | Path) -> Scenario:
    """The scenario in a TOML file. Raises ValueError, in one line with the place in the file."""
    return parse_scenario(read_text(path, "a scenario"), str(path))


def parse_scenario(text: str, name: str) -> Scenario:
    """The scenario that a TOML text describes; `name` is the file's, for errors.

    Raises ValueError, in one line with the line of what is wrong.
    """
    return parse_toml(text, name, _scenario)


def _number(value: object) -> Fraction:
    if isinstance(value, bool) or not isinstance(value, int | Decimal):
        raise ValueError(f"a number is needed, not {value}")
    if isinstance(value, Decimal) and not (value.is_finite() and abs(value.adjusted()) < 30):
        raise ValueError(f"a number is needed, not {value}")
    return Fraction(value)


def _decimal(value: object) -> float:
    return float(_number(value))


def _whole(value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise ValueError(f"a whole number is needed, not {value}")
    return value


def _text(value: object) -> str:
    if not isinstance(value, str):
        raise ValueError(f"a text is needed, not {value}")
    return value


def _side(value: object) -> Side:
    names = [side.name.lower() for side in Side]
    if value not in names:
        raise ValueError(f"a side must be {' or '.join(names)}, not {value}")
    return Side[str(value).upper()]


def _times(value: object) -> tuple[Fraction, ...]:
    if not isinstance(value, list):
        raise ValueError(f"a list of numbers is needed, not {value}")
    return tuple(map(_number, value))


@dataclass(frozen=True)
class _Table:
    """The keys of one table: how each is read, which must be there, and what is made of them."""

    make: Callable[..., Any]
    keys: Mapping[str, Reader]
    required: tuple[str, ...] = ()


RUN = _Table(
    dict,
    {
        "name": _text,
        "unit": _text,
        "seed": _whole,
        "ppm_1": _number,
        "ppm_2": _number,
        "skew_s": _number,
        "acknowledged_s": _times,
    },
    ("name",),
)
TRAIN = _Table(dict, dict.fromkeys(("speed_kmh", "acceleration_m_s2", "braking_m_s2"), _decimal))
STOP = _Table(Stop, {"at_m": _decimal, "side": _side, "dwell_s": _decimal}, ("at_m",))
SENSOR = _Table(
    Sensor,
    dict.fromkeys(
        ("duty", "phase_deg", "tooth_error", "jitter_s", "dropouts", "glitches_hz", "glitch_s"),
        _decimal,
    ),
)
RULE = _Table(Rule, dict.fromkeys(("window_m", "creep_m", "still_s", "closes_s"), _decimal))
RELAY = _Table(RelayTimes, {"pick_up_s": _number, "release_s": _number})
FAULT = _Table(
    dict,
    {
        "part": _text,
        "kind": _text,
        "at_s": _number,
        "at_m": _decimal,
        "lasts_s": _number,
        "value": _whole,
        "axle": _whole,
    },
    ("part", "kind"),
)
TABLES = {"train": TRAIN, "sensor": SENSOR, "rule": RULE, "relay": RELAY}
ARRAYS = {"stop": STOP, "fault": FAULT}


def _read(kind: _Table, given: object, table: str, number: int = 0) -> Any:
    """What a table makes. Raises MisplacedError."""
    if not isinstance(given, dict):
        raise MisplacedError((table, 0, ""), f"{table} must be a table, not {given}")
    entries = {}
    for key, value in given.items():
        place = (table, number, key)
        if key not in kind.keys:
            known = ", ".join((*kind.keys, *(TABLES | ARRAYS if not table else ())))
            raise MisplacedError(place, f'no key "{key}" is known; there are: {known}')
        try:
            entries[key] = kind.keys[key](value)
        except ValueError as error:
            raise MisplacedError(place, f"{key}: {error}") from error
    for key in kind.required:
        if key not in entries:
            raise MisplacedError((table, number, ""), f"the key {key} is missing")
    try:
        return kind.make(**entries)
    except ValueError as error:
        raise MisplacedError((table, number, _guilty(entries, error)), str(error)) from error


def _guilty(entries: Mapping[str, Any], error: ValueError) -> str:
    """The key that an error begins with, if it does with one."""
    return next((key for key in entries if str(error).startswith(key)), "")


def _array(kind: _Table, given: object, table: str) -> Iterator[Any]:
    if not isinstance(given, list):
        raise MisplacedError((table, 0, ""), f"{table} must be an array of tables, [[{table}]]")
    for number, each in enumerate(given):
        yield _read(kind, each, table, number)


def _scenario(document: dict[str, Any]) -> Scenario:
    nested = TABLES | ARRAYS
    entries = _read(RUN, {k: v for k, v in document.items() if k not in nested}, "")
    read = {table: _read(kind, document.get(table, {}), table) for table, kind in TABLES.items()}
    stops, faults = (
        tuple(_array(kind, document.get(table, []), table)) for table, kind in ARRAYS.items()
    )
    train = read.pop("train")
    try:
        route = Route(stops=stops, **train)
    except ValueError as error:
        key = _guilty(train, error)
        place = ("train", 0, key) if key else ("stop", max(len(stops) - 1, 0), "")
        raise MisplacedError(place, str(error)) from error
    begun = Scenario(route=route, **entries, **read)
    return replace(begun, faults=_faults(begun, faults))


def _faults(scenario: Scenario, given: tuple[dict[str, Any], ...]) -> tuple[Fault, ...]:
    """The faults, those at places at the times at which the train is there."""
    found: list[Fault] = []
    for number, each in enumerate(given):
        try:
            found.append(_fault(scenario, dict(each)))
            replace(scenario, faults=tuple(found))
        except ValueError as error:
            place = ("fault", number, _guilty(each, error))
            raise MisplacedError(place, str(error)) from error
    return tuple(found)


def _fault(scenario: Scenario, each: dict[str, Any]) -> Fault:
    """Raises ValueError."""
    if ("at_s" in each) == ("at_m" in each):
        raise ValueError("a fault must have at_s or at_m, and one of them only")
    if (place := each.pop("at_m", None)) is not None:
        way = place - scenario.route.start_m
        there = scenario.profile.crossings(np.array([way]))
        if not there.size:
            raise ValueError(f"at_m must be passed by the train, not {place:g} m")
        each["at_s"] = Fraction(round(float(there[0]) * 1_000_000), 1_000_000)
    start, lasts = each.pop("at_s"), each.pop("lasts_s", None)
    if lasts is not None and lasts <= 0:
        raise ValueError(f"lasts_s must be above 0, not {float(lasts):g}")
    return Fault(start_s=start, end_s=None if lasts is None else start + lasts, **each)
