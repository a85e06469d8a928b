"""Which pin of a board each pin of a target is, from TOML files, as those beside this module are.

A table has the pins of one thing that is wired to the board, a key each: `uart`, `sensor_1`,
`sensor_2`, `link`, `channel`, with the names that gateware.Top has for them. A pin is one of the
FPGA's package, "B11", or one of a connector that amaranth-boards knows, "gpio_0:0+"; where there is
one for each output it is a list. The table `attributes` has what all pins are set to, as the
part's tools call it. Tables that the target does not need may be missing, and may share pins.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from importlib import resources
from pathlib import Path
from typing import Any

from amaranth.build import Platform
from amaranth.lib.wiring import Out, Signature

from railgate.fpga.boards.board import board
from railgate.fpga.gateware.top import PINS
from railgate.toml_file import MisplacedError, parse_toml, read_text

__all__ = ["Pin", "builtin_pins", "read_pins"]

ATTRIBUTES = "attributes"


@dataclass(frozen=True)
class Pin:
    """A member of a top: its path there, the package's pins for its bits, what they are set to."""

    path: tuple[str, str]
    package: tuple[str, ...]
    out: bool
    attributes: Mapping[str, str | int]


def builtin_pins(on: str, needed: Signature, platform: Platform) -> tuple[Pin, ...]:
    """As `read_pins`, of a board's own file, which is called as its module."""
    file = resources.files(__package__).joinpath(f"{board(on).module}.toml")
    return _parse(file.read_text("utf-8"), file.name, needed, platform)


def read_pins(path: str | Path, needed: Signature, platform: Platform) -> tuple[Pin, ...]:
    """Of all members of a top, by its signature. Raises ValueError, in one line with the place in
    the file, for what is wrong with it, also where the platform has no such connector or pin."""
    return _parse(read_text(path, "a file of pins"), str(path), needed, platform)


def _parse(text: str, name: str, needed: Signature, platform: Platform) -> tuple[Pin, ...]:
    return parse_toml(text, name, partial(_pins, needed=needed, platform=platform))


def _pins(document: dict[str, Any], needed: Signature, platform: Platform) -> tuple[Pin, ...]:
    attributes = _checked(document)
    connectors = {
        f"{each.name}_{each.number}:{pin}": package
        for each in platform.connectors.values()
        for pin, package in each.mapping.items()
    }
    taken = dict.fromkeys(_oscillator(platform), "the oscillator")
    found = []
    for table, member in needed.members.items():
        if table not in document:
            raise MisplacedError((table, 0, ""), f"the table {table} is missing")
        for key, port in member.signature.members.items():
            if key not in document[table]:
                raise MisplacedError((table, 0, ""), f"the key {key} is missing")
            place = (table, 0, key)
            named = list(_named(place, document[table][key], port.shape))
            package = tuple(_package(place, pin, connectors) for pin in named)
            for pin in package:
                if (other := taken.setdefault(pin, f"{table}.{key}")) != f"{table}.{key}":
                    raise MisplacedError(place, f"{key}: pin {pin} must be free, not {other}'s")
            if len(set(package)) != len(package):
                raise MisplacedError(place, f"{key}: pins must differ, not be {', '.join(named)}")
            found.append(Pin((table, key), package, port.flow == Out, attributes))
    return tuple(found)


def _checked(document: Mapping[str, Any]) -> Mapping[str, str | int]:
    """The attributes, of a document in which all tables and keys are known."""
    for table, keys in document.items():
        place = (table, 0, "")
        if table not in (*PINS, ATTRIBUTES):
            known = ", ".join((*PINS, ATTRIBUTES))
            raise MisplacedError(place, f'no table "{table}" is known; there are: {known}')
        if not isinstance(keys, dict):
            raise MisplacedError(("", 0, table), f"{table} must be a table, [{table}]")
        for key, value in keys.items():
            if table == ATTRIBUTES:
                if not isinstance(value, str | int) or isinstance(value, bool):
                    raise MisplacedError((table, 0, key), f"{key} must be a text or a whole number")
            elif key not in PINS[table]:
                known = ", ".join(PINS[table])
                raise MisplacedError(
                    (table, 0, key), f'no key "{key}" is known; there are: {known}'
                )
    return document.get(ATTRIBUTES, {})


def _named(place: tuple[str, int, str], value: object, count: int) -> Iterator[str]:
    """The pins of one key, one each bit."""
    several: list[Any] = value if isinstance(value, list) else [value]
    if len(several) != count or not all(isinstance(pin, str) and pin for pin in several):
        wanted = 'a pin, as "A1"' if count == 1 else f"a list of {count} pins"
        raise MisplacedError(place, f"{place[2]} must be {wanted}, not {value}")
    yield from several


def _package(place: tuple[str, int, str], pin: str, connectors: Mapping[str, str]) -> str:
    if ":" not in pin:
        return pin
    if pin not in connectors:
        connector = pin.partition(":")[0]
        there = [each.partition(":")[2] for each in connectors if each.startswith(f"{connector}:")]
        known = there or sorted({each.partition(":")[0] for each in connectors})
        raise MisplacedError(
            place, f"{place[2]} must be at one of {', '.join(known) or 'no connector'}, not {pin}"
        )
    return connectors[pin]


def _oscillator(platform: Platform) -> list[str]:
    """The package's pin of it."""
    return platform.lookup(platform.default_clk).ios[0].names
