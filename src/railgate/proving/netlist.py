"""A monitor as the solvers read it: RTLIL in which what it claims is asserted."""

from __future__ import annotations

from amaranth.back import rtlil
from amaranth.hdl import Assert, Assume, Cover, Fragment, Module, Value
from amaranth.hdl._ir import PortDirection
from amaranth.lib.wiring import In

from railgate.engines.border import flat
from railgate.proving.monitor import Monitor

__all__ = ["netlist"]


def netlist(monitor: Monitor, *, helped: bool) -> str:
    """The monitor's RTLIL: `holds` asserted, `assumed` assumed, `reached` covered.

    helped: its lemmas are asserted too. Inputs, clk, rst and `holds` are the ports, an interface's
    members joined by `__`. The same in every process. Raises ValueError where a domain is not sync.
    """
    m = Module()
    m.submodules.monitor = monitor
    m.d.comb += [Assume(monitor.assumed), Assert(monitor.holds), Cover(monitor.reached)]
    if helped:
        m.d.comb += [Assert(getattr(monitor.lemma, name)) for name in monitor.lemmas]
    ports = {
        flat(path): (Value.cast(value), PortDirection.Input)
        for path, member, value in monitor.signature.flatten(monitor)
        if member.flow == In
    }
    ports["holds"] = (monitor.holds, PortDirection.Output)
    prepared = Fragment.get(m, None).prepare(ports=ports)
    if odd := set(prepared.fragment.domains) - {"sync"}:
        raise ValueError(f"a monitor must be in domain sync alone, not in {', '.join(odd)} too")
    text, _ = rtlil.convert_fragment(prepared, emit_src=False)
    return str(text)
