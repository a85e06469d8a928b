"""A component's ports, and that its RTLIL does not depend on the process."""

import os
import subprocess
import sys

from amaranth.hdl import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from railgate.engines.border import bordered, flat

DOMAINS = ("sync", "link", "peer", "relay")


class Several(wiring.Component):
    """A register in each of DOMAINS."""

    def __init__(self) -> None:
        inside = wiring.Signature({"a": In(1)})
        super().__init__({"told": Out(len(DOMAINS)), "sensor": Out(inside).array(2)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        for bit, domain in enumerate(DOMAINS):
            m.d[domain] += self.told[bit].eq(self.sensor[0].a ^ self.sensor[1].a)
        return m


def ports() -> list[str]:
    return [name for name, _, _ in bordered(Several()).ports]


def test_members_are_called_by_their_paths_and_domains_follow_in_order() -> None:
    members = [flat(path) for path in (["told"], ["sensor", 0, "a"], ["sensor", 1, "a"])]
    clocks = ["link_clk", "link_rst", "peer_clk", "peer_rst", "relay_clk", "relay_rst"]
    assert ports() == [*members, *clocks, "sync_clk", "rst"]


def test_the_order_is_the_same_whatever_the_hashes_are() -> None:
    program = "from engines.test_border import ports; print(ports())"
    for seed in range(4):
        told = subprocess.run(
            [sys.executable, "-c", program],
            env=os.environ | {"PYTHONHASHSEED": str(seed), "PYTHONPATH": os.pathsep.join(sys.path)},
            check=True,
            capture_output=True,
            text=True,
        )
        assert told.stdout == f"{ports()}\n"
