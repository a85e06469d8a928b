"""A component's ports as an engine names them, and the check of a stimulus against them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from amaranth.hdl import Value
from amaranth.lib.wiring import Out

from railgate.engines.design import Clock, Design
from railgate.waves import Trace
from railgate.waves.waveform import storage

if TYPE_CHECKING:
    from amaranth.lib import wiring

__all__ = ["Port", "check", "ports"]


@dataclass(frozen=True)
class Port:
    """One signal at the border of a design.

    name: the path joined by dots, as `sensor.0.a`. width: bits, at most 64. path: attribute names
    and indices from the component to the signal; of a reset just its name.
    """

    name: str
    width: int
    signed: bool
    output: bool
    path: tuple[str | int, ...]


def ports(component: wiring.Component, clocks: Sequence[Clock]) -> tuple[Port, ...]:
    """The members of the signature in its order, a structure as one unsigned number, then the
    reset of each clock's domain: `rst`, or `<domain>_rst` of a domain other than sync.

    Raises ValueError where a member is wider than a signal may be.
    """
    found = []
    for path, member, value in component.signature.flatten(component):
        shape = Value.cast(value).shape()
        storage(shape.width)
        name = ".".join(str(part) for part in path)
        found.append(Port(name, shape.width, shape.signed, member.flow == Out, tuple(path)))
    for clock in clocks:
        name = "rst" if clock.domain == "sync" else f"{clock.domain}_rst"
        found.append(Port(name, 1, False, False, (name,)))
    return tuple(found)


def check(stimulus: Trace, design: Design, now: int, until: int, inputs: Sequence[Port]) -> None:
    """Raises ValueError unless `stimulus` drives only `inputs` of `design`, in its time base, with
    their widths, and covers now ≤ tick < until."""
    if stimulus.period != design.period:
        raise ValueError(
            f"a tick of {design.name}'s stimulus must last {design.period} s, "
            f"not {stimulus.period} s"
        )
    if until < now:
        raise ValueError(f"{design.name} is at tick {now} already, it cannot run to tick {until}")
    if until > now and not stimulus.start <= now <= until <= stimulus.end:
        raise ValueError(
            f"the stimulus must cover ticks {now}..{until}, not {stimulus.start}..{stimulus.end}"
        )
    there = {port.name: port for port in inputs}
    for name, wave in stimulus.signals.items():
        port = there.get(name)
        if port is None:
            raise ValueError(
                f'no input "{name}" in {design.name}; there are: {", ".join(there) or "none"}'
            )
        if (wave.width, wave.signed) != (port.width, port.signed):
            raise ValueError(
                f'"{name}" must be {kind(port.width, port.signed)}, '
                f"not {kind(wave.width, wave.signed)}"
            )


def kind(width: int, signed: bool) -> str:
    """A signal's shape in words, as `8 bits signed`."""
    return f"{width} bit{'s' * (width > 1)}{' signed' * signed}"
