"""The compiled engine: Amaranth → RTLIL → Yosys (CXXRTL) → C++ → one shared object."""

from __future__ import annotations

import re
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path

from amaranth.back import rtlil

from railgate.engines.border import bordered, flat
from railgate.engines.compiler import cached, compile_shared, cxxrtl_include, yosys
from railgate.engines.design import Clock, Design
from railgate.engines.native import Native
from railgate.engines.ports import ports, registers
from railgate.engines.signals import Port, Register

__all__ = ["Cxxrtl", "netlist", "run_loop"]

LEVEL_SENSITIVE = re.compile(r"cell \$(adff|aldff|dffsr|adlatch|dlatch|sr|sdlatch)")
"""Cells that change in the same tick as their inputs, so that one pass does not settle."""


class Cxxrtl(Native):
    """Runs a design as machine code; the first time it is built, which takes seconds.

    Registers keep their hierarchical names, `sensor_0.position`. Raises ValueError where a tool is
    missing, where a clock is, or where a clock is made inside the design.
    """

    def __init__(self, design: Design) -> None:
        signals, pokable, netlist_text = netlist(design)
        harness = files("railgate.engines").joinpath("cxxrtl.cc").read_text(encoding="utf-8")
        names = repr([(port.name, port.output) for port in signals])
        clocks = repr(([clock.domain for clock in design.clocks], design.single))
        loop = run_loop()

        def build(made: Path) -> None:
            folder = made.parent
            yosys(netlist_text, ["write_cxxrtl -O6 -g3 design.cc"], folder)
            generated = (folder / "design.cc").read_text(encoding="utf-8")
            lists = _lists(design, signals, generated, netlist_text)
            source = folder / "engine.cc"
            source.write_text("\n".join((generated, lists, harness, loop)), encoding="utf-8")
            compile_shared([source], [cxxrtl_include()], made)

        this = Path(__file__).read_text(encoding="utf-8")  # script and macros are made here
        sources = "\n".join((netlist_text, names, clocks, harness, loop, this))
        super().__init__(design, signals, pokable, cached(design.name, sources, build))


def netlist(design: Design) -> tuple[tuple[Port, ...], dict[str, Register], str]:
    """The design's ports, its registers as they are written out, and its RTLIL.

    All are the same in every process.
    """
    component = design.component()
    prepared = bordered(component)
    signals = ports(component, design.clocks)
    text, _ = rtlil.convert_fragment(prepared, emit_src=False)
    return signals, {found.written: found.register for found in registers(prepared, 1)}, text


def run_loop() -> str:
    """The C++ run loop, for any simulator that gives a Machine."""
    return files("railgate.engines").joinpath("loop.cc").read_text(encoding="utf-8")


def _lists(design: Design, signals: tuple[Port, ...], generated: str, text: str) -> str:
    """The macros by which cxxrtl.cc walks through ports, clocks and state."""
    clocks = [clock_port(clock) for clock in design.clocks]
    inputs = [port for port in signals if not port.output]
    outputs = [port for port in signals if port.output]
    there = re.findall(r"/\*(?:input|output)\*/ \w+<\d+> (\w+);", generated)
    _check_clocks(design, clocks, inputs, generated)
    state = re.findall(r"^\t(?:/\*\w+\*/ )?wire<\d+> (\w+);", generated, re.MULTILINE)
    state += re.findall(r"^\tmemory<\d+> (\w+) ", generated, re.MULTILINE)
    edges = {i: _member(clock) for i, clock in enumerate(clocks)}
    edges = {i: clock for i, clock in edges.items() if f"prev_{clock};" in generated}
    settle = LEVEL_SENSITIVE.search(text) is not None or "converged = false" in generated
    return f"""
#define INPUTS(X) {_listed(inputs, there)}
#define OUTPUTS(X) {_listed(outputs, there)}
#define CLOCKS(X) {" ".join(f"X({i}, {clock}, prev_{clock})" for i, clock in edges.items())}
#define STATE(X) {" ".join(f"X({member})" for member in state)}
namespace railgate {{
constexpr size_t kInputs = {len(inputs)}, kOutputs = {len(outputs)}, kClocks = {len(clocks)};
constexpr bool kSingle = {int(design.single)}, kSettle = {int(settle)};
}}
"""


def _listed(signals: Sequence[Port], there: Sequence[str]) -> str:
    """X(index, member, offset) for each of the signals that Yosys kept."""
    members = [(_member(flat(port.path)), port.offset) for port in signals]
    return " ".join(
        f"X({i}, {name}, {offset})" for i, (name, offset) in enumerate(members) if name in there
    )


def _check_clocks(
    design: Design, clocks: Sequence[str], inputs: Sequence[Port], generated: str
) -> None:
    """Raises ValueError unless every edge in the design is a rising one of its own clocks."""
    known = {_member(name) for name in (*clocks, *(flat(port.path) for port in inputs))}
    known |= {f"posedge_{_member(clock)}" for clock in clocks}
    found = re.findall(r"/\*input\*/ \w+<\d+> (\w+);", generated)
    found += re.findall(r"bool ((?:pos|neg)edge_\w+)\(\)", generated)
    odd = [name for name in found if name not in known]
    if odd:
        raise ValueError(
            f"{design.name} needs a clock for each domain and rising edges of these only, "
            f"{', '.join(clocks)}, not {', '.join(odd)}"
        )


def clock_port(clock: Clock) -> str:
    """The name of a clock's port."""
    return f"{clock.domain}_clk"


def _member(name: str) -> str:
    """The C++ name that CXXRTL gives to an RTLIL name."""
    return "p_" + re.sub(
        r"\W|_", lambda odd: "__" if odd[0] == "_" else f"_{ord(odd[0]):02x}_", name
    )
