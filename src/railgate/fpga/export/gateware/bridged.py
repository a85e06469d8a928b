"""What has registers, behind a bridge."""

from __future__ import annotations

from amaranth.hdl import Module, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import Out

__all__ = ["Bridged"]

BUS = "bus"


class Bridged(wiring.Component):
    """A component with the internal bus as `bus`, in, and a bridge with it as `bus`, out.

    All other members of both, with their meaning.
    """

    def __init__(self, served: wiring.Component, bridge: wiring.Component) -> None:
        self._parts = {"served": served, "bridge": bridge}
        members = {**served.signature.members, **bridge.signature.members}
        super().__init__({name: member for name, member in members.items() if name != BUS})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        wiring.connect(m, self._parts["bridge"].bus, self._parts["served"].bus)
        ports = {path: Value.cast(port) for path, _, port in self.signature.flatten(self)}
        for name, part in self._parts.items():
            m.submodules[name] = part
            for path, member, port in part.signature.flatten(part):
                if path[0] != BUS:
                    inside, outside = Value.cast(port), ports[path]
                    m.d.comb += outside.eq(inside) if member.flow == Out else inside.eq(outside)
        return m
