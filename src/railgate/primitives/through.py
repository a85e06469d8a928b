"""Members of what is inside as those of what is around it."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

from amaranth.hdl import Module, Value
from amaranth.lib.wiring import Out

__all__ = ["through"]


def through(m: Module, outside: Any, inside: Any, names: Collection[str]) -> None:
    """Give `outside` the members of these names that `inside` has: ports, interfaces, arrays.

    Both are components or interfaces. What `inside` tells comes out there, the rest is fed to it.
    """
    ports = {path: Value.cast(port) for path, _, port in outside.signature.flatten(outside)}
    for path, member, port in inside.signature.flatten(inside):
        if path[0] in names:
            inner, outer = Value.cast(port), ports[path]
            m.d.comb += outer.eq(inner) if member.flow == Out else inner.eq(outer)
