"""A component with its members as ports, on its way to RTLIL."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from amaranth.hdl import ClockDomain, Fragment, Signal, Value
from amaranth.hdl._ir import PortDirection
from amaranth.hdl._xfrm import DomainCollector
from amaranth.lib import wiring
from amaranth.lib.wiring import Out

__all__ = ["bordered", "flat"]


def flat(path: Iterable[object]) -> str:
    """The name that a member has as a port: `sensor__0__a`."""
    return "__".join(map(str, path))


def bordered(component: wiring.Component, platform: object = None, top: str = "top") -> Any:
    """What Amaranth converts to RTLIL, the same in every process; `top` is the module's name.

    A member of the signature is a port, see `flat`. A domain that the component does not define has
    its clock as the port `<domain>_clk`, so that a member may be called `clk`, and its synchronous
    reset as `rst`, of a domain other than sync `<domain>_rst`.
    """
    ports = {
        flat(path): (
            Value.cast(value),
            PortDirection.Output if member.flow == Out else PortDirection.Input,
        )
        for path, member, value in component.signature.flatten(component)
    }
    fragment = Fragment.get(component, platform)
    domains = DomainCollector()
    domains(fragment)
    for name in sorted(domains.used_domains - domains.defined_domains):
        domain = ClockDomain(name)
        domain.clk = Signal(name=f"{name}_clk")
        fragment.add_domains(domain)
        ports |= {each.name: (each, PortDirection.Input) for each in (domain.clk, domain.rst)}
    return fragment.prepare(ports=ports, hierarchy=(top,))
