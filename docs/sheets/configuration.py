"""Configurations: each number with its default, the limits that it is held to, and what it is."""

from __future__ import annotations

import inspect
import re
from collections.abc import Mapping
from dataclasses import MISSING, Field, fields, replace
from enum import IntEnum
from fractions import Fraction
from typing import Any

from railgate.odometer.host import Rolling
from railgate.odometer.spec import Assumptions
from sheets.functions import FUNCTIONS
from sheets.markdown import between, number, table
from sheets.told import told

__all__ = ["configuration", "derived"]

OTHERS = {"assumptions": Assumptions(), "rolling": Rolling()}
LIMITS = re.compile(r"(\w+) must be between (\S+) and (\S+), not")
FAR = 10**40
"""Beyond every limit, and after it as far the other way."""


def configuration(name: str) -> str:
    """A table of a configuration's fields: of a function, `assumptions` or `rolling`."""
    config: Any = OTHERS[name] if name in OTHERS else FUNCTIONS[name].config
    names = [field.name for field in fields(config)]
    meanings = dict(told(inspect.getdoc(type(config)) or "", names))
    rows = [
        (f"`{f.name}`", _default(config, f), _limits(config, f.name), _meaning_of(f.name, meanings))
        for f in fields(config)
    ]
    return table(("name", "default", "limits", "what it is"), rows)


def _meaning_of(name: str, meanings: Mapping[str, str]) -> str:
    """What is told of it, or of another where it is named."""
    mentions = (text for text in meanings.values() if re.search(rf"\b{name}\b", text))
    return (meanings.get(name) or next(mentions, "")).removesuffix(".")


def _default(config: object, field: Field[Any]) -> str:
    value = getattr(config, field.name)
    assert field.default is not MISSING, "configurations have defaults"
    if field.name.startswith(("polynomial", "link_polynomial")):
        return f"`{value:#010x}`"
    if isinstance(value, tuple):
        return ", ".join(f"`{each:#x}`" for each in value)
    if isinstance(value, Fraction):
        return f"`{float(value):g}`"
    return f"`{value!r}`" if not isinstance(value, IntEnum) else f"`{value.name}`"


def _limits(config: Any, name: str) -> str:
    """What the configuration itself says when it is far beyond."""
    value = getattr(config, name)
    if isinstance(value, bool) or not isinstance(value, int | float | Fraction):
        return ""
    try:
        replace(config, **{name: -FAR})
    except ValueError as error:
        found = LIMITS.match(str(error))
        if found and found[1] == name:
            return between(*(number(Fraction(limit)) for limit in found.groups()[1:]))
    return ""


def derived(name: str) -> str:
    """What follows from a function's default configuration: each number with its meaning."""
    config = FUNCTIONS[name].config
    rows = [
        (f"`{each}`", number(getattr(config, each)), _doc(prop))
        for each, prop in inspect.getmembers(type(config), lambda it: isinstance(it, property))
        if isinstance(getattr(config, each), int | float | Fraction)
    ]
    return table(("name", "value", "what it is"), rows)


def _doc(prop: property) -> str:
    text = " ".join((inspect.getdoc(prop) or "").split())
    return text.split(". ")[0].removesuffix(".")
