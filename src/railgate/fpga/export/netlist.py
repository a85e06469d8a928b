"""A core as RTLIL: ports called by their paths, synchronisers marked, no paths of this machine."""

from __future__ import annotations

import re

from amaranth.back import rtlil
from amaranth.hdl import ClockDomain, Fragment, Module, Signal, Value
from amaranth.hdl._ir import PortDirection
from amaranth.lib import cdc, wiring
from amaranth.lib.wiring import Out

__all__ = ["MARK", "netlist"]

MARK = "ASYNC_REG"
"""The attribute of a synchroniser's flip-flops: to be kept close together, not to be shared."""


class Marking:
    """The platform for which synchronisers are as without one, but marked."""

    def get_ff_sync(self, synchroniser: cdc.FFSynchronizer) -> Module:
        """See Amaranth, lib.cdc."""
        m = Module()
        stages = [
            Signal(
                synchroniser.i.shape(),
                name=f"stage{index}",
                init=synchroniser._init,
                reset_less=synchroniser._reset_less,
                attrs={MARK: "TRUE"},
            )
            for index in range(synchroniser._stages)
        ]
        for before, stage in zip((synchroniser.i, *stages), stages, strict=False):
            m.d[synchroniser._o_domain] += stage.eq(before)
        m.d.comb += synchroniser.o.eq(stages[-1])
        return m


def netlist(component: wiring.Component, name: str) -> str:
    """RTLIL whose top module is called `name`, the same in every process.

    A member of the signature is a port, its path joined by `__`, as `sensor__0__a`; a clock is
    `<domain>_clk`, its synchronous reset `rst`, of a domain other than sync `<domain>_rst`. A
    module inside is called by its path, as `<name>__sensor_0`.
    """
    ports = {
        "__".join(map(str, path)): (
            Value.cast(value),
            PortDirection.Output if member.flow == Out else PortDirection.Input,
        )
        for path, member, value in component.signature.flatten(component)
    }
    fragment = Fragment.get(component, Marking())
    prepared = fragment.prepare(ports=ports, hierarchy=(name,), missing_domain=_domain)
    text, _ = rtlil.convert_fragment(prepared, name=name, emit_src=False)
    inside = re.compile(rf"(?<=\\{name})(?:\.[\w.$]+)")
    text = inside.sub(lambda found: found[0].replace(".", "__"), str(text))
    # Names that Amaranth has made are Yosys's to choose.
    return re.sub(r"(?<= )\\(\$\d+)(?=\s)", r"\1", text)


def _domain(name: str) -> ClockDomain:
    domain = ClockDomain(name)
    domain.clk = Signal(name=f"{name}_clk")
    return domain
