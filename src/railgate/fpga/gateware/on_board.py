"""A top on a board: its pins through the part's buffers, its clocks from the oscillator."""

from __future__ import annotations

from collections.abc import Mapping

from amaranth.build import Platform
from amaranth.hdl import ClockDomain, Module
from amaranth.lib import io, wiring
from amaranth.lib.wiring import Out

from railgate.fpga.gateware.clocks import PLLS, Start
from railgate.fpga.pll import Setting

__all__ = ["OnBoard", "clock_nets", "resource"]


def resource(path: tuple[str | int, ...]) -> str:
    """The name of the platform's resource for a top's pin."""
    return "_".join(map(str, path))


def clock_nets(domain: str) -> tuple[str, ...]:
    """The names that tools may have for a domain's clock, which in the netlist has all of them."""
    return str(ClockDomain(domain).clk.name), f"{domain}_pll.clk", f"{domain}_pll.clock"


class OnBoard(wiring.Component):
    """What a bitstream is made of. settings: of the PLL of each domain of top. family: of which of
    PLLS. pad: the oscillator comes in on the PLL's own pad.

    The platform has a resource for each member of top, called by `resource`, and its oscillator.
    """

    def __init__(
        self, top: wiring.Component, settings: Mapping[str, Setting], family: str, *, pad: bool
    ) -> None:
        self._top = top
        self._settings = settings
        self._family = family
        self._pad = pad
        super().__init__({})

    def elaborate(self, platform: Platform) -> Module:
        m = Module()
        m.submodules.top = top = self._top
        for path, member, value in top.signature.flatten(top):
            port = platform.request(name := resource(path), dir="-")
            out = member.flow == Out
            m.submodules[f"{name}_buffer"] = pin = io.Buffer("o" if out else "i", port)
            m.d.comb += pin.o.eq(value) if out else value.eq(pin.i)

        reference = (oscillator := platform.request(platform.default_clk, dir="-")).io
        if not self._pad:
            m.submodules.oscillator_buffer = buffer = io.Buffer("i", oscillator)
            reference = buffer.i
        for domain, setting in self._settings.items():
            m.submodules[f"{domain}_pll"] = pll = PLLS[self._family](setting, reference)
            m.submodules[f"{domain}_start"] = start = Start(int(setting.hz))
            m.domains += (driven := ClockDomain(domain))
            platform.add_clock_constraint(driven.clk, float(setting.hz))
            m.d.comb += [
                driven.clk.eq(pll.clk),
                driven.rst.eq(start.rst),
                start.clk.eq(driven.clk),
                start.locked.eq(pll.locked),
            ]
        return m
