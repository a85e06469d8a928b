"""Options that several commands share: a dataclass whose fields are spread into them."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable
from dataclasses import fields
from fractions import Fraction
from typing import Any, get_type_hints

import typer

from railgate import quantity

__all__ = ["finite", "limit_s", "option", "whole_hz", "with_setup"]


def option(help: str, *names: str) -> Any:
    """An option of a setup, with its help."""
    return typer.Option(*names, help=help)


def finite(name: str, value: float) -> Fraction:
    """The number as it was written. Raises ValueError."""
    if not math.isfinite(value):
        raise ValueError(f"{name} must be a finite number, not {value}")
    return Fraction(str(value))


def limit_s(text: str) -> float:
    """The time that --limit gives. Raises ValueError."""
    seconds = float(quantity.time_s(text))
    if seconds <= 0:
        raise ValueError(f"--limit must be above 0 s, not {text}")
    return seconds


def whole_hz(name: str, text: str) -> int:
    """A clock's frequency. Raises ValueError."""
    frequency = quantity.frequency_hz(text)
    if frequency.denominator != 1:
        raise ValueError(f"{name} must be a whole number of Hz, not {text}")
    return int(frequency)


def with_setup(command: Callable[..., None]) -> Callable[..., None]:
    """A command whose last parameter, `setup`, is a dataclass: its fields become options."""
    hints = get_type_hints(command, include_extras=True)
    setup_type = hints["setup"]
    shared = get_type_hints(setup_type, include_extras=True)
    own = [
        parameter.replace(annotation=hints[parameter.name])
        for parameter in inspect.signature(command).parameters.values()
        if parameter.name != "setup"
    ]
    spread = [
        inspect.Parameter(
            field.name,
            inspect.Parameter.KEYWORD_ONLY,
            default=field.default,
            annotation=shared[field.name],
        )
        for field in fields(setup_type)
    ]

    def spread_out(**given: Any) -> None:
        setup = setup_type(**{field.name: given.pop(field.name) for field in fields(setup_type)})
        command(**given, setup=setup)

    parameters = [p.replace(kind=inspect.Parameter.KEYWORD_ONLY) for p in own] + spread
    spread_out.__name__, spread_out.__doc__ = command.__name__, command.__doc__
    spread_out.__annotations__ = {p.name: p.annotation for p in parameters}
    spread_out.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    return spread_out
