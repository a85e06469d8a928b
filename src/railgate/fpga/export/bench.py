"""A test bench in plain Verilog that replays a core's vectors."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Any

from amaranth.hdl import Value
from amaranth.lib.wiring import In

from railgate.engines.border import flat
from railgate.fpga.export.targets import Core
from railgate.fpga.export.vectors import Vectors

__all__ = ["bench"]


@dataclass(frozen=True)
class Port:
    """One of the core's. start: of an input, until the vectors tell."""

    name: str
    escaped: str
    width: int
    output: bool
    start: int = 0

    @property
    def range(self) -> str:
        return "" if self.width == 1 else f"[{self.width - 1}:0] "

    @property
    def local(self) -> str:
        return f"{'out' if self.output else 'in'}_{self.name}"


def bench(core: Core, vectors: Vectors, verilog: str) -> dict[str, Any]:
    """What the template bench.sv is filled with, for the core as this Verilog."""
    told = {flat(port.path): port for port in vectors.signals}
    ports = list(_ports(core, verilog, told))
    names = {port.name: port for port in ports}
    signals = []
    for port in vectors.signals:
        of = names[flat(port.path)]
        part = "" if of.width == port.width else f"[{port.offset} +: {port.width}]"
        side = "must" if port.output else "in"
        signals.append({"target": f"{side}_{of.name}{part}", "width": port.width})
    return {
        "ticks": vectors.trace.end,
        "ports": ports,
        "inputs": [port for port in ports if not port.output],
        "outputs": [port for port in ports if port.output],
        "compared": [port for port in ports if port.output and port.name in told],
        "signals": signals,
    }


def _ports(core: Core, verilog: str, told: Collection[str]) -> Iterator[Port]:
    """Clock, reset, and the members of the core's signature; one that the vectors do not tell of,
    as a bus, rests."""
    yield Port("sync_clk", "sync_clk", 1, False)
    yield Port("rst", "rst", 1, False)
    reserved = set(re.findall(r"^  (?:in|out)put .*\\(\w+) ;$", verilog, re.M))
    for path, member, value in core.component.signature.flatten(core.component):
        name = flat(path)
        escaped = f"\\{name} " if name in reserved else name
        signal = Value.cast(value)
        rests = 0 if name in told else signal.init & (1 << len(signal)) - 1
        yield Port(name, escaped, len(signal), member.flow != In, rests)
