"""A component behind registered pins, so that a part's pins bound neither its size nor its speed.

shift_in ─► register ─► … ─► register        one a bit of the inputs
               │               │
            ┌──▼───────────────▼──┐
    rst ─►  │      component      │           rst through two registers
            └──┬───────────────┬──┘
            register        register          one a bit of its outputs
               ▼               ▼
       0 ─► ⊕ register ─► … ─► ⊕ register ─► shift_out
"""

from __future__ import annotations

from amaranth.back import rtlil
from amaranth.hdl import (
    Cat,
    ClockDomain,
    ClockSignal,
    Const,
    Elaboratable,
    Module,
    ResetSignal,
    Signal,
    Value,
)
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.engines.border import bordered
from railgate.fpga.gateware.instance import instance

__all__ = ["INSIDE", "netlist"]

TOP = "top"

INSIDE = "component"
"""The component's module in a netlist, a part of module `top`."""


class Pins(wiring.Component):
    """Feeds a component, of domain sync alone, and collects all that it tells.

    clk, rst, shift_in: in, 1 bit. shift_out: out, 1 bit. A path from or to one of them has its
    register next to the pin, and each output bit of the component can be seen in shift_out, so that
    nothing of it is optimised away. inside: what stands in the component's place and has its
    members for ports; None: the component itself. Requirement SYS-3.
    """

    def __init__(self, component: wiring.Component, inside: Elaboratable | None = None) -> None:
        self._component = component
        self._inside = inside or component
        super().__init__(
            {name: In(1) for name in ("clk", "rst", "shift_in")} | {"shift_out": Out(1)}
        )

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.domains.sync = sync = ClockDomain()
        m.domains.pins = pins = ClockDomain(reset_less=True)
        m.submodules[INSIDE] = self._inside
        members = list(self._component.signature.flatten(self._component))
        told, fed = (
            Cat(Value.cast(value) for _, member, value in members if member.flow == flow)
            for flow in (Out, In)
        )

        resets = Signal(2)
        m.d.comb += [sync.clk.eq(self.clk), pins.clk.eq(self.clk), sync.rst.eq(resets[-1])]
        m.d.pins += resets.eq(Cat(self.rst, resets))

        shifted = Signal(len(fed))
        m.d.pins += shifted.eq(Cat(self.shift_in, shifted))
        m.d.comb += fed.eq(shifted)

        taken, chain = Signal(len(told)), Signal(len(told))
        m.d.pins += [taken.eq(told), chain.eq(Cat(Const(0, 1), chain) ^ taken)]
        m.d.comb += self.shift_out.eq(chain[-1])
        return m


def netlist(component: wiring.Component) -> str:
    """RTLIL of the component, with the ports of `bordered`, and of `top`, which puts it behind its
    pins, with ports clk, rst, shift_in, shift_out. The same in every process.

    Raises ValueError where it needs another domain than sync.
    """
    prepared = bordered(component, top=INSIDE)
    for domain in prepared.fragment.domains:
        if domain != "sync":
            raise ValueError(f"what is placed must be in domain sync alone, not in {domain} too")
    inside = instance(INSIDE, component, sync_clk=ClockSignal(), rst=ResetSignal())
    pins = Pins(component, inside)
    modules = (INSIDE, prepared), (TOP, bordered(pins, top=TOP))
    texts = [rtlil.convert_fragment(made, name=name, emit_src=False)[0] for name, made in modules]
    return "".join(texts)
