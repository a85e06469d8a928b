"""A module of other sources in the place of a component."""

from __future__ import annotations

from amaranth.hdl import Instance, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import Out

from railgate.engines.border import flat

__all__ = ["instance"]


def instance(module: str, component: wiring.Component, **inputs: Value) -> Instance:
    """The module of that name, whose ports are the component's members, see `flat`, and further
    inputs."""
    members = {
        f"{'o' if member.flow == Out else 'i'}_{flat(path)}": Value.cast(value)
        for path, member, value in component.signature.flatten(component)
    }
    return Instance(module, **{f"i_{name}": value for name, value in inputs.items()}, **members)
