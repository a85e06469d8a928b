"""Bridges as outside judges drive them: as Verilog in Verilator, by the bus masters of cocotb's
extensions. The cocotb tests are the modules of `judges`; they run in the simulator's process."""

from __future__ import annotations

import fcntl
import os
from hashlib import sha256
from pathlib import Path
from unittest import mock

from amaranth.back import rtlil
from amaranth.hdl import Fragment, Module, Value
from amaranth.hdl._ir import PortDirection
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out
from cocotb_tools.check_results import get_results
from cocotb_tools.runner import Runner, get_runner

from railgate.engines.compiler import yosys
from railgate.registers import Map
from railgate.registers.gateware import (
    AxiLite,
    Bank,
    Decoder,
    Wishbone,
    address_bits,
    axi_signature,
    wishbone_signature,
)
from registers.gateware.two_blocks import MAP
from verilated import environment

__all__ = ["judge"]


class Judged(wiring.Component):
    """Each bridge before a decoder and banks of its own; `events`: in, 8 bits, of all of them."""

    def __init__(self, map_: Map) -> None:
        self._map = map_
        bits = address_bits(map_.size)
        members = {"axi": In(axi_signature(bits)), "wb": In(wishbone_signature(bits))}
        super().__init__({**members, "events": In(8)})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        bits = address_bits(self._map.size)
        for name, bridge in (("axi", AxiLite(bits)), ("wb", Wishbone(bits))):
            m.submodules[name] = bridge
            m.submodules[f"{name}_decoder"] = decoder = Decoder(self._map)
            wiring.connect(m, wiring.flipped(getattr(self, name)), getattr(bridge, name))
            wiring.connect(m, bridge.bus, decoder.bus)
            for block in self._map.blocks.values():
                m.submodules[f"{name}_{block.name}"] = bank = Bank(block)
                wiring.connect(m, getattr(decoder.served, block.name), bank.bus)
                m.d.comb += getattr(bank, f"{block.name}_events").eq(self.events)
        return m


def judge(module: str, scratch: Path) -> None:
    """Runs the cocotb tests of that module, in an empty folder; each of them must pass."""
    with mock.patch.dict(os.environ, environment()):
        runner = get_runner("verilator")
        folder = _built(runner)
        results = runner.test(
            hdl_toplevel="judged", test_module=module, build_dir=folder, test_dir=scratch
        )
    ran, failed = get_results(results)
    assert ran
    assert not failed


def _built(runner: Runner) -> Path:
    """The folder with the simulator of the design, made by one process at a time."""
    text = _rtlil()
    name = sha256(text.encode()).hexdigest()[:16]
    folder = Path(__file__).parents[3] / "build" / "judged" / name
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (folder / "judged.v").exists():
            script = ["rename top judged", "proc", "flatten", "write_verilog -noattr made.v"]
            yosys(text, script, folder)
            (folder / "made.v").replace(folder / "judged.v")
        runner.build(
            sources=[folder / "judged.v"],
            hdl_toplevel="judged",
            build_dir=folder,
            build_args=["-Wno-fatal", "-Wno-lint"],
            timescale=("1ns", "1ps"),
        )
    return folder


def _rtlil() -> str:
    """The design, a port by its path joined by an underscore, as `axi_awaddr`."""
    judged = Judged(MAP)
    ports = {
        "_".join(map(str, path)): (
            Value.cast(value),
            PortDirection.Output if member.flow == Out else PortDirection.Input,
        )
        for path, member, value in judged.signature.flatten(judged)
    }
    prepared = Fragment.get(judged, None).prepare(ports=ports)
    return rtlil.convert_fragment(prepared, emit_src=False)[0]
