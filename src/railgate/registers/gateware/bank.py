"""A bank of registers: what a block declares, on the bus."""

from __future__ import annotations

from amaranth.hdl import Cat, Const, Module, Mux, Shape, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Member, Out

from railgate.registers.block import Block, Gate, Group
from railgate.registers.gateware.access import BusAccess
from railgate.registers.gateware.bus import address_bits, bus_signature
from railgate.registers.gateware.sticky import Sticky
from railgate.registers.register import WORD_BITS, WORD_BYTES, Access, Register

__all__ = ["Bank"]


class Bank(wiring.Component):
    """Serves the registers of one block, in domain sync.

    bus: in, see bus_signature. A request is answered 3 ticks later; one to read of a group with
    Gate.STROBE as soon after that as no strobe is under way. A read or write of what is not there,
    or that the register's access does not allow, has no effect and is answered with an error.

    One port each, of the field's name, width and sign:
    - in, of a register to read: what it holds. Of a sticky one without counters: each bit sets its
      own in each tick in which it is 1.
    - out, of a register to read and write, and of one that triggers.
    strobe: out, 1 bit, and busy: in, 1 bit, where there is a Gate.STROBE: busy is 1 from the tick
    after a strobe on until the fields have changed; a field called `strobe` that triggers does so
    by the same port. <group>_ready: out, 1 bit, of a Gate.TAKE.

    A sticky bit that is set in the tick in which it is cleared stays set. Requirements ODO-6,
    ODO-7.
    """

    def __init__(self, block: Block) -> None:
        self._block = block
        members = {"bus": In(bus_signature(address_bits(block.size)))}
        for register in block.registers:
            members |= _ports(register)
        for group in block.groups:
            if group.gate is Gate.STROBE:
                members |= {"strobe": Out(1), "busy": In(1)}
            elif group.gate is Gate.TAKE:
                members[_ready(group)] = Out(1)
        super().__init__(members)

    def elaborate(self, _platform: object) -> Module:
        m = Module()
        m.submodules.access = access = BusAccess(address_bits(self._block.size))
        wiring.connect(m, wiring.flipped(self.bus), access.bus)
        told: dict[str, Value] = {}
        for group in self._block.groups:
            told |= self._group(m, access, group)
        for place in self._block.places:
            if not place.group:
                selected = access.index == place.offset // WORD_BYTES
                told[place.register.name] = self._alone(m, access, place.register, selected)
        with m.Switch(access.index):
            for place in self._block.places:
                firsts = [place.offset] if place.again is None else [place.offset, place.again]
                value = told[place.register.name]
                for at in range(place.register.words):
                    with m.Case(*(first // WORD_BYTES + at for first in firsts)):
                        m.d.comb += [
                            access.told.eq(value[at * WORD_BITS :]),
                            access.readable.eq(place.register.access.reads),
                            access.writable.eq(place.register.access.writes),
                        ]
        return m

    def _group(self, m: Module, access: BusAccess, group: Group) -> dict[str, Value]:
        """What is read of each register of a group."""
        first = self._block.place(group.name).offset // WORD_BYTES
        gate = access.gate & (access.index == first)
        fields = {register.name: self._fields(register) for register in group.registers}
        if group.gate is Gate.STROBE:
            inside = (access.index >= first) & (access.index < first + 2 * group.words)
            m.d.comb += access.waits.eq(inside & self.busy)
            with m.If(gate):
                m.d.comb += self.strobe.eq(1)
            return fields
        if group.gate is Gate.TAKE:
            m.d.comb += getattr(self, _ready(group)).eq(gate)
        shadows = {}
        for name, value in fields.items():
            shadows[name] = shadow = Signal(len(value), name=f"{name}_shadow")
            with m.If(gate):
                m.d.sync += shadow.eq(value)
        return shadows

    def _alone(self, m: Module, access: BusAccess, register: Register, selected: Value) -> Value:
        """What is read of a register that stands alone; does what an access to it does."""
        if register.access is Access.CONSTANT:
            return Cat(Const(field.start, field.width) for field in register.fields)
        if register.access is Access.READ:
            return self._fields(register)
        written = Mux(access.write & selected, access.data & access.mask, 0)
        if register.access is Access.READ_TO_CLEAR:
            return self._sticky(m, register, Mux(access.read & selected, ~0, 0))
        if register.access is Access.WRITE_ONE_TO_CLEAR:
            return self._sticky(m, register, written)
        if register.access is Access.READ_WRITE:
            held = self._fields(register)
            kept = Mux(access.write & selected, ~access.mask, ~0)
            m.d.sync += held.eq((held & kept) | written)
            return held
        for field, shift in zip(register.fields, register.shifts, strict=True):
            triggered = written[shift : shift + field.width]
            with m.If(triggered.any()):
                m.d.comb += getattr(self, field.name).eq(triggered)
        return Const(0)

    def _sticky(self, m: Module, register: Register, clears: Value) -> Value:
        """Its bits."""
        m.submodules[f"{register.name}_sticky"] = sticky = Sticky(register.width)
        sets = self._steps(m, register) if register.counters else self._fields(register)
        m.d.comb += [sticky.sets.eq(sets), sticky.clears.eq(clears)]
        return sticky.held

    def _steps(self, m: Module, register: Register) -> Value:
        """A bit for each of its counters: it has stepped by one, to what it is in this tick."""
        lowest = Cat(getattr(self, name)[0] for name in register.counters)
        starts = [self._block.fields[name].start & 1 for name in register.counters]
        init = sum(start << at for at, start in enumerate(starts))
        before = Signal(len(starts), init=init, name=f"{register.name}_before")
        m.d.sync += before.eq(lowest)
        return lowest ^ before

    def _fields(self, register: Register) -> Value:
        """Its fields' ports."""
        return Cat(getattr(self, field.name) for field in register.fields)


def _ports(register: Register) -> dict[str, Member]:
    """One of each field that is the function's matter."""
    if register.access is Access.CONSTANT or register.counters:
        return {}
    if register.access in (Access.READ_WRITE, Access.TRIGGER):
        return {
            field.name: Out(Shape(field.width, field.signed), init=field.start)
            for field in register.fields
        }
    return {field.name: In(Shape(field.width, field.signed)) for field in register.fields}


def _ready(group: Group) -> str:
    return f"{group.name}_ready"
