"""A design's signals, and what every engine holds a stimulus and a poke to."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from railgate.waves import Trace
from railgate.waves.waveform import MAX_WIDTH

__all__ = ["LAST_TICK", "WIDEST", "Port", "Register", "check", "chosen", "parts", "poked"]

LAST_TICK = (1 << 63) - (1 << 58)
"""Ticks are int64; what is left above it is for the clock edges after the last tick."""

WIDEST = 4096
"""Bits of the widest member that is taken apart into signals."""


@dataclass(frozen=True)
class Port:
    """One signal at the border of a design: a member of its signature, or a part of a wide one.

    name: the path joined by dots, as `sensor.0.a`; of a part its number too, as `word.3`, see
    `parts`. width: bits, at most 64. signed: of a signed wide member only the last part is. path:
    attribute names and indices from the component to the member; of a reset just its name.
    offset: the bit of the member at which this signal begins.
    """

    name: str
    width: int
    signed: bool
    output: bool
    path: tuple[str | int, ...]
    offset: int = 0


def parts(name: str, width: int) -> tuple[tuple[str, int, int], ...]:
    """The signals that carry a member of `width` bits: name, width and offset in bits of each.

    Up to 64 bits it is one by the member's own name. A wider one has the parts `<name>.0`,
    `<name>.1`, … of 64 bits, least significant first, the last one of the bits that remain.
    Raises ValueError where the member has no bits, or more than WIDEST.
    """
    if not 1 <= width <= WIDEST:
        raise ValueError(f'"{name}" must be between 1 and {WIDEST} bits wide, not {width}')
    if width <= MAX_WIDTH:
        return ((name, width, 0),)
    return tuple(
        (f"{name}.{offset // MAX_WIDTH}", min(MAX_WIDTH, width - offset), offset)
        for offset in range(0, width, MAX_WIDTH)
    )


@dataclass(frozen=True)
class Register:
    """A register that can be poked, by its path below the component, as `sensor_0.position`.

    width: bits, 1 to 64.
    """

    name: str
    width: int
    signed: bool


def check(
    stimulus: Trace, design: str, period: Fraction, now: int, until: int, inputs: Sequence[Port]
) -> None:
    """Raises ValueError unless `stimulus` drives only `inputs`, with their widths, in ticks of
    `period`, and covers now ≤ tick < until; `design` is what it is for, by name."""
    if stimulus.period != period:
        raise ValueError(
            f"a tick of {design}'s stimulus must last {period} s, not {stimulus.period} s"
        )
    if until < now:
        raise ValueError(f"{design} is at tick {now} already, it cannot run to tick {until}")
    if until > LAST_TICK:
        raise ValueError(f"{design} must end at tick {LAST_TICK} at the latest, not {until}")
    if until > now and not stimulus.start <= now <= until <= stimulus.end:
        raise ValueError(
            f"the stimulus must cover ticks {now}..{until}, not {stimulus.start}..{stimulus.end}"
        )
    there = {port.name: port for port in inputs}
    for name, wave in stimulus.signals.items():
        port = there.get(name)
        if port is None:
            raise ValueError(
                f'no input "{name}" in {design}; there are: {", ".join(there) or "none"}'
            )
        if (wave.width, wave.signed) != (port.width, port.signed):
            raise ValueError(
                f'"{name}" must be {_kind(port.width, port.signed)}, '
                f"not {_kind(wave.width, wave.signed)}"
            )


def _kind(width: int, signed: bool) -> str:
    """A signal's shape in words, as `8 bits signed`."""
    return f"{width} bit{'s' * (width > 1)}{' signed' * signed}"


def chosen(outputs: Collection[str] | None, there: Iterable[str], design: str) -> list[str]:
    """Those of the outputs `there` that are asked for, all for None, in their order.

    Raises ValueError where `design` has not one of them, naming those there are.
    """
    names = list(there)
    if outputs is None:
        return names
    for name in outputs:
        if name not in names:
            raise ValueError(f'no output "{name}" in {design}; there are: {", ".join(names)}')
    return [name for name in names if name in outputs]


def poked(registers: Mapping[str, Register], design: str, name: str, value: int) -> Register:
    """The register of that name.

    Raises ValueError where `design` has none, naming those there are, or where it cannot hold
    `value`.
    """
    register = registers.get(name)
    if register is None:
        raise ValueError(
            f'no register "{name}" in {design}; there are: {", ".join(registers) or "none"}'
        )
    low = -(1 << register.width - 1) if register.signed else 0
    high = low + (1 << register.width) - 1
    if not low <= value <= high:
        raise ValueError(f'"{name}" must be between {low} and {high}, not {value}')
    return register
