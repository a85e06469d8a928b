"""A core as RTLIL: ports called by their paths, synchronisers marked, no paths of this machine."""

from __future__ import annotations

import re

from amaranth.back import rtlil
from amaranth.hdl import Module, Signal
from amaranth.lib import cdc, wiring

from railgate.engines.border import bordered

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

    Its ports are those of `bordered`. A module inside is called by its path, `<name>__sensor_0`.
    """
    prepared = bordered(component, Marking(), name)
    text, _ = rtlil.convert_fragment(prepared, name=name, emit_src=False)
    inside = re.compile(rf"(?<=\\{name})(?:\.[\w.$]+)")
    text = inside.sub(lambda found: found[0].replace(".", "__"), str(text))
    # Names that Amaranth has made are Yosys's to choose.
    return re.sub(r"(?<= )\\(\$\d+)(?=\s)", r"\1", text)
