"""Every asynchronous input has a synchroniser, and each of these its constraints."""

from __future__ import annotations

import re

import pytest
from amaranth.hdl import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.wiring import In, Out

from railgate.fpga.export import core
from railgate.fpga.export.borders import borders
from railgate.fpga.export.netlist import netlist
from railgate.fpga.export.verilog import translate

PINS = {
    ("odometer", "none"): {f"sensor__{n}__{pin}" for n in (0, 1) for pin in "ab"},
    ("position_link", "axi4-lite"): {"uef", "data"},
    ("unit", "local"): {
        *(f"sensor__{n}__{pin}" for n in (0, 1) for pin in "ab"),
        *("link__uef", "link__data", "channel__link_rx"),
        *("channel__pulse_feedback[*]", "channel__contact[*]"),
        *("cs_n", "oe_n", "we_n[*]", "address[*]", "data_in[*]"),
    },
}
"""Of some cores the inputs whose own documentation says that they are asynchronous."""
cores = pytest.mark.parametrize("which", PINS, ids="-".join)


@cores
def test_each_asynchronous_input_is_without_timing(exported, which) -> None:
    made = exported(*which)
    sdc = re.findall(r"^set_false_path -from \[get_ports \{(.*)\}\]$", made.text(".sdc"), re.M)
    assert len(sdc) == len(set(sdc))
    assert set(sdc) == PINS[which]
    lpf = re.findall(r'^BLOCK PATH FROM PORT "(.*)";$', made.text(".lpf"), re.M)
    assert lpf == sdc


@cores
def test_each_flip_flop_that_such_an_input_ends_at_is_named_in_the_verilog(exported, which) -> None:
    made = exported(*which)
    xdc, verilog = made.text(".xdc"), made.text(".v")
    ends = re.findall(r"^set_false_path -to \[get_pins \{(.*)_reg\*/D\}\]$", xdc, re.M)
    assert len(ends) >= len([pin for pin in PINS[which] if pin not in ("address[*]", "data_in[*]")])
    for end in ends:
        *instances, register = end.split("/")
        module = made.name
        for instance in instances:
            body = body_of(verilog, module)
            module = re.search(rf"^  \\?(\S+) +\\?{re.escape(instance)} +\($", body, re.M)[1]
        declared = rf"\(\* ASYNC_REG = \"TRUE\" \*\)\n  reg (?:\[\d+:0\] )?{register} = "
        assert re.search(declared, body_of(verilog, module)), end


def body_of(verilog: str, module: str) -> str:
    (body,) = re.findall(
        rf"^module \\?{re.escape(module)} ?\((.*?)^endmodule", verilog, re.M | re.S
    )
    return body


def test_what_crosses_from_clock_to_clock_may_take_a_tick_of_the_one_that_reads(exported) -> None:
    made = exported("unit", "local")
    told = made.text(".sdc")
    assert "create_clock -name sync_clk -period 62.5 [get_ports {sync_clk}]" in told
    assert "create_clock -name link_clk -period 25 [get_ports {link_clk}]" in told
    for source, sink, period in (("sync", "link", "25"), ("link", "sync", "62.5")):
        ends = f"-from [get_clocks {{{source}_clk}}] -to [get_clocks {{{sink}_clk}}]"
        assert f"set_max_delay {period} {ends}" in told
    assert 'FREQUENCY PORT "link_clk" 40 MHZ;' in made.text(".lpf")
    assert made.text(".xdc").count("set_max_delay -datapath_only") == 2


class Pair(wiring.Component):
    """good passes a synchroniser, bad the second of its stages only, both reads it twice."""

    def __init__(self) -> None:
        super().__init__({name: In(1) for name in ("good", "bad", "both")} | {"out": Out(3)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        seen = Signal()
        m.submodules.one = FFSynchronizer(self.good, self.out[0])
        m.submodules.two = FFSynchronizer(self.both, seen)
        m.d.sync += [self.out[1].eq(self.bad), self.out[2].eq(self.both & seen)]
        return m


def test_an_input_that_a_plain_register_reads_is_not_asynchronous() -> None:
    found = borders(translate(netlist(Pair(), "pair"), "pair").flat)
    assert found.synchronised == {"good": ("one.stage0",)}
    assert {name: found.clocks[name] for name in ("good", "bad", "both")} == {
        "good": (),
        "bad": ("sync_clk",),
        "both": ("sync_clk",),
    }


@pytest.mark.parametrize("target", ["odometer", "position_link", "unit"])
def test_every_input_has_a_clock_or_a_synchroniser(target) -> None:
    of = core(target)
    found = borders(translate(netlist(of.component, of.name), of.name).flat)
    for path, member, _ in of.component.signature.flatten(of.component):
        name = "__".join(map(str, path))
        if member.flow == In:
            assert bool(found.clocks[name]) != (name in found.synchronised), name
