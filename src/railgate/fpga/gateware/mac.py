"""LiteEth's Ethernet MAC, placed for scale beside the functions: a core that many know."""

from __future__ import annotations

import re
from functools import cache

from amaranth.hdl import ClockSignal, Module, ResetSignal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.fpga.gateware.instance import instance

__all__ = ["LiteEthMac", "verilog"]

MODULE = "liteeth_mac"
BYTE = 8
DOMAINS = ("sys", "eth_tx", "eth_rx")
"""LiteEth's, here all of one clock."""
PORT = re.compile(
    r"^\t(?P<way>input|output) (?:reg )?(?:\[(?P<high>\d+):0\] )?(?P<name>\w+),?$", re.M
)
"""Of Migen's Verilog."""


class LiteEthMac(wiring.Component):
    """Preamble, CRC, padding and gap of both directions, and the queues between the clocks.

    Members are those of LiteEth's streams of a byte a tick, to and from the PHY and the user; it
    instantiates what `verilog` has. Raises ValueError where LiteEth is missing.
    """

    def __init__(self) -> None:
        _, ports = _converted()
        super().__init__({name: (Out if out else In)(width) for name, width, out in ports})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        clocks = {name: ClockSignal() for name in _clocked("clk")}
        resets = {name: ResetSignal() for name in _clocked("rst")}
        m.submodules.mac = instance(MODULE, self, **clocks, **resets)
        return m


def verilog() -> str:
    """LiteEth's own."""
    text, _ = _converted()
    return text


@cache
def _converted() -> tuple[str, tuple[tuple[str, int, bool], ...]]:
    """Migen's Verilog of the core, and name, width, and whether it is an output, of each port."""
    try:
        from liteeth.common import eth_phy_description
        from liteeth.mac.core import LiteEthMACCore
        from litex.soc.interconnect.stream import Endpoint
        from migen.fhdl.verilog import convert
    except ImportError:
        raise ValueError("liteeth is needed: pip install liteeth") from None

    class Phy:
        dw = BYTE
        sink = Endpoint(eth_phy_description(BYTE))
        source = Endpoint(eth_phy_description(BYTE))

    core = LiteEthMACCore(Phy, BYTE)
    streams = (Phy.source, Phy.sink, core.sink, core.source)
    text = str(convert(core, {each for s in streams for each in s.flatten()}, name=MODULE))
    return text, tuple(
        (found["name"], int(found["high"] or 0) + 1, found["way"] == "output")
        for found in PORT.finditer(text)
        if found["name"] not in (*_clocked("clk"), *_clocked("rst"))
    )


def _clocked(what: str) -> list[str]:
    return [f"{domain}_{what}" for domain in DOMAINS]
