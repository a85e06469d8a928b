"""A function with the bank that serves its registers."""

from __future__ import annotations

from functools import reduce
from operator import or_

from amaranth.hdl import Module, Value
from amaranth.lib import data, wiring
from amaranth.lib.wiring import Out

from railgate.registers.block import Block
from railgate.registers.gateware.bank import Bank

__all__ = ["Mapped"]


class Mapped(wiring.Component):
    """A function and its bank, in domain sync.

    bus: in, see bus_signature. All members of the function's own signature, with their meaning; an
    input that the bank drives too, as `strobe`, is what either of them drives, one or the other.

    The bank's ports are the function's of that name: the path joined by underscores, as
    `sensor_0_pulses`, of a stream's payload that of the stream and its field, as
    `sensor_0_stamps_ticks`. Raises ValueError where the function has not one of them.
    """

    def __init__(self, function: wiring.Component, block: Block) -> None:
        self._function = function
        self._bank = Bank(block)
        members = self._bank.signature.members
        self._served = members.keys() - {"bus"}
        leaves = function.signature.flatten(function)
        there = {name for path, _, port in leaves for name in _parts(path, port)}
        if missing := self._served - there:
            raise ValueError(f"{block.name} needs a port for {', '.join(sorted(missing))}")
        super().__init__({**function.signature.members, "bus": members["bus"]})

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.submodules.function = function = self._function
        m.submodules.bank = bank = self._bank
        wiring.connect(m, wiring.flipped(self.bus), bank.bus)
        ports = {path: Value.cast(port) for path, _, port in self.signature.flatten(self)}
        for path, member, port in function.signature.flatten(function):
            inside, outside = Value.cast(port), ports[path]
            parts = _parts(path, port)
            served = {name: getattr(bank, name) for name in parts.keys() & self._served}
            if member.flow == Out:
                m.d.comb += outside.eq(inside)
                m.d.comb += [served[name].eq(parts[name]) for name in served]
            else:
                m.d.comb += inside.eq(reduce(or_, served.values(), outside))
        return m


def _parts(path: tuple[str | int, ...], port: Value | data.View) -> dict[str, Value]:
    """A port by its name; one with a layout, by the names of its fields."""
    name = "_".join(str(part) for part in path if part != "payload")
    if isinstance(port, data.View):
        return {f"{name}_{field}": port[field] for field, _ in port.shape()}
    return {name: port}
