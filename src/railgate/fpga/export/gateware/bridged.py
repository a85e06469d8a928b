"""What has registers, behind a bridge."""

from __future__ import annotations

from amaranth.hdl import Module
from amaranth.lib import wiring

from railgate.primitives import through

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
        for name, part in self._parts.items():
            m.submodules[name] = part
            through(m, self, part, part.signature.members.keys() - {BUS})
        return m
