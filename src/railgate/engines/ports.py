"""A component's ports and registers, as an engine names them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from amaranth.hdl import Value
from amaranth.lib.wiring import Out

from railgate.engines.design import Clock
from railgate.engines.signals import Port, Register, parts
from railgate.waves.waveform import MAX_WIDTH

if TYPE_CHECKING:
    from amaranth.lib import wiring

__all__ = ["Driven", "ports", "registers"]


def ports(component: wiring.Component, clocks: Sequence[Clock]) -> tuple[Port, ...]:
    """The members of the signature in its order, a structure as one unsigned number and a wide one
    in its parts, then the reset of each clock's domain: `rst`, or `<domain>_rst` of a domain other
    than sync.

    Raises ValueError where a member is too wide, and where two signals have the same name.
    """
    found = []
    for path, member, value in component.signature.flatten(component):
        shape = Value.cast(value).shape()
        name = ".".join(str(part) for part in path)
        for part, width, offset in parts(name, shape.width):
            signed = shape.signed and offset + width == shape.width
            found.append(Port(part, width, signed, member.flow == Out, tuple(path), offset))
    for clock in clocks:
        name = "rst" if clock.domain == "sync" else f"{clock.domain}_rst"
        found.append(Port(name, 1, False, False, (name,)))
    for name, count in Counter(port.name for port in found).items():
        if count > 1:
            raise ValueError(
                f'each signal must have a name of its own, not {count} of them "{name}"'
            )
    return tuple(found)


@dataclass(frozen=True)
class Driven:
    """A register of a component: its signal, and the path it is written out by, as RTLIL's."""

    register: Register
    signal: Value
    written: str


def registers(prepared: Any, component: int) -> Iterator[Driven]:
    """Each named signal of 1 to 64 bits that a clock changes, by its path below the component.

    prepared: Amaranth's design with all names given. component: how deep in it the component is.
    A register keeps its name where a port has it too, and is written out by another one; a
    second register of the same path is `<path>$2`.
    """
    seen: Counter[str] = Counter()
    for fragment, info in prepared.fragments.items():
        folder = info.name[component:]
        for domain, statements in fragment.statements.items():
            for signal in statements._lhs_signals() if domain != "comb" else ():
                shape = signal.shape()
                if signal.name and 1 <= shape.width <= MAX_WIDTH:
                    path = ".".join((*folder, signal.name))
                    seen[path] += 1
                    name = f"{path}${seen[path]}" if seen[path] > 1 else path
                    written = ".".join((*folder, info.signal_names[signal]))
                    yield Driven(Register(name, shape.width, shape.signed), signal, written)
