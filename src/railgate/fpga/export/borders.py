"""What crosses a core's borders, found in its netlist: pins that no clock is right for, and paths
from one clock to another."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from railgate.fpga.export.netlist import MARK

__all__ = ["Borders", "borders"]

Bit = int


@dataclass(frozen=True)
class Borders:
    """synchronised: of each asynchronous input the flip-flops that it ends at, each the first one
    of a synchroniser, by its path, as `sensor_0.input_a.synchroniser.stage0`. clocks: of each port
    those of the registers that it comes from or goes to, synchronisers not counted; a port without
    any is a clock, asynchronous, or goes straight through. between: pairs of clocks, from and to,
    between which there is a path. widths: of each port, in bits."""

    synchronised: Mapping[str, tuple[str, ...]]
    clocks: Mapping[str, tuple[str, ...]]
    between: tuple[tuple[str, str], ...]
    widths: Mapping[str, int]


def borders(netlist: Mapping[str, Any]) -> Borders:
    """Of a flat netlist of registers and combinational cells, as Yosys's write_json tells it."""
    (module,) = netlist["modules"].values()
    graph = _Graph(module)
    clocks: dict[str, set[str]] = {name: set() for name in module["ports"]}
    synchronised: dict[str, tuple[str, ...]] = {}
    for name, port in module["ports"].items():
        if port["direction"] != "input":
            continue
        ends = graph.ends(port["bits"])
        marked = ends & graph.marked.keys()
        clocks[name] |= {graph.clock[bit] for bit in ends - marked}
        if marked and not clocks[name]:
            synchronised[name] = tuple(sorted(graph.marked[bit] for bit in marked))
    between = set()
    for clock in set(graph.clock.values()):
        starts = [bit for bit, its in graph.clock.items() if its == clock]
        reached = graph.reached(starts)
        between |= {(clock, graph.clock[bit]) for bit in graph.ends(starts)} - {(clock, clock)}
        for name, port in module["ports"].items():
            if port["direction"] == "output" and reached & set(port["bits"]):
                clocks[name].add(clock)
    return Borders(
        synchronised=synchronised,
        clocks={name: tuple(sorted(its)) for name, its in clocks.items()},
        between=tuple(sorted(between)),
        widths={name: len(port["bits"]) for name, port in module["ports"].items()},
    )


class _Graph:
    """Who reads each bit. clock: the port that clocks a register's bit. marked: the path of each
    bit of a synchroniser."""

    def __init__(self, module: Mapping[str, Any]) -> None:
        name_of = {
            bit: name
            for name, port in module["ports"].items()
            if port["direction"] == "input"
            for bit in port["bits"]
        }
        self.clock: dict[Bit, str] = {}
        self._follow: dict[Bit, set[Bit]] = defaultdict(set)
        self._end: dict[Bit, set[Bit]] = defaultdict(set)
        for cell in module["cells"].values():
            directions, bits = cell.get("port_directions", {}), cell["connections"]
            if "CLK" in bits:
                self._register(bits, name_of[bits["CLK"][0]])
                continue
            told = {b for port, to in directions.items() if to == "output" for b in bits[port]}
            for port, to in directions.items():
                if to == "input":
                    for bit in bits[port]:
                        self._follow[bit] |= told
        self.marked = {
            bit: path
            for path, net in sorted(module["netnames"].items(), reverse=True)
            if MARK in net["attributes"]
            for bit in net["bits"]
        }

    def _register(self, bits: Mapping[str, list[Bit]], clock: str) -> None:
        self.clock |= dict.fromkeys(bits["Q"], clock)
        for port, read in bits.items():
            if port == "D":
                for bit, held in zip(read, bits["Q"], strict=True):
                    self._end[bit].add(held)
            elif port not in ("CLK", "Q"):
                for bit in read:
                    self._end[bit] |= set(bits["Q"])

    def reached(self, starts: Iterable[Bit]) -> set[Bit]:
        """The bits that these make within a tick, themselves too."""
        found, left = set(starts), list(starts)
        while left:
            new = self._follow.get(left.pop(), set()) - found
            found |= new
            left += new
        return found

    def ends(self, starts: Iterable[Bit]) -> set[Bit]:
        """The bits of registers that these make in the next tick."""
        return {held for bit in self.reached(starts) for held in self._end.get(bit, ())}
