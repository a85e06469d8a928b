"""The ports of a function's gateware, from its signature; what they mean, from its docstring."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator, Mapping

from amaranth.hdl import Shape
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Member

from sheets.functions import function
from sheets.markdown import table
from sheets.told import told

__all__ = ["ports"]

FLOW = re.compile(r"(?:in|out), ?")
SHAPE = re.compile(r"(?:\d+ bits?|one bit an output(?: each)?)[,. ]*")


def ports(name: str) -> str:
    """A table of the ports of a function with its default configuration. Raises ValueError."""
    of = function(name)
    component = of.top(of.config)
    members = component.signature.members
    meanings = _meanings(component, [*_names(members)]) | _fields(of.config)
    rows = [
        (f"`{path}`", "in" if member.flow == In else "out", _width(member), meanings.get(owner, ""))
        for path, owner, member in _flat(members)
    ]
    return table(("port", "direction", "bits", "meaning"), rows)


def _flat(members: Mapping[str, Member], prefix: str = "") -> Iterator[tuple[str, str, Member]]:
    """Of each port its path, the name under which its meaning is told, and itself.

    Of an array of interfaces those of one; a single interface is told of as a whole.
    """
    for name, member in members.items():
        if member.is_port:
            yield prefix + name, name, member
        elif member.dimensions:
            yield from _flat(member.signature.members, f"{prefix}{name}[n].")
        else:
            inner = _flat(member.signature.members, f"{prefix}{name}.")
            yield from ((path, f"{name}.", port) for path, _, port in inner)


def _names(members: Mapping[str, Member]) -> Iterator[str]:
    for name, member in members.items():
        yield name
        if not member.is_port:
            yield from _names(member.signature.members)


def _width(member: Member) -> str:
    return str(Shape.cast(member.shape).width)


def _meanings(component: wiring.Component, names: list[str]) -> dict[str, str]:
    """Port -> what the docstring says of it; of an interface, by its name and a dot, all of it.

    A port of which nothing but its shape is told shares what is told of the next.
    """
    found: dict[str, str] = {}
    after = ""
    for name, text in reversed(list(told(inspect.getdoc(type(component)) or "", names))):
        sentence = FLOW.sub("", text, count=1).split(". ")[0].strip(" .-")
        after = SHAPE.sub("", sentence, count=1) or after
        found |= {name: after, f"{name}.": sentence}
    return found


def _fields(config: object) -> dict[str, str]:
    """Fields, whose meaning and unit the configuration tells."""
    names = ("common_fields", "sensor_fields", "fields")
    fields = [each for name in names for each in getattr(config, name, ())]
    return {f.name: f.meaning + (f", {f.unit}" if f.unit else "") for f in fields}
