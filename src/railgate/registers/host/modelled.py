"""The registers of a function that runs without a bank, in any engine: the bank as a model.

Written from the docstrings of `registers.block` and `registers.register`, not from the gateware.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from railgate.field import Field
from railgate.registers.block import Block, Gate, Group, Place
from railgate.registers.host.bus import AccessError, NoAnswerError, addresses
from railgate.registers.host.running import Running
from railgate.registers.register import WORD_BYTES, Access
from railgate.waves.waveform import MAX_WIDTH

__all__ = ["ModelledBus"]

SERVED = (Access.CONSTANT, Access.READ, Access.WRITE_ONE_TO_CLEAR, Access.TRIGGER)
STROBE, BUSY = "strobe", "busy"
ACTING = 2
"""Steps of a trigger: it acts in the first, and a strobe is busy in the second."""
STROBING = 32
"""Steps between two looks whether a strobe is over."""
PATIENCE = 64
"""Looks."""


class ModelledBus:
    """A block over its function's own ports: called as the fields, but for `prefix`, as `fpga_1.`,
    and dots where fields have underscores.

    An access takes no time but what a strobe takes; what triggers acts in the first step after it.
    Served is what the functions declare: no stream, nothing to be both read and written, sticky
    registers by counters. Raises ValueError.
    """

    def __init__(self, block: Block, running: Running, prefix: str = "") -> None:
        _require_served(block)
        self._running, self._prefix = running, prefix
        self._words = dict(_words(block))
        self._triggers = [field.name for field in _fields(block, Access.TRIGGER)]
        self._setters = {
            counter: field.name
            for register in block.registers
            for field, counter in zip(register.fields, register.counters, strict=False)
        }
        there = running.run({}, 1).signals
        read = [*_fields(block, Access.READ)]
        if any(group.gate is Gate.STROBE for group in block.groups):
            read.append(Field(BUSY, 1, ""))
            self._triggers.append(STROBE)
        self._ports = {field.name: _ports(field, prefix, there) for field in read}
        constant = {field.name: field.start for field in _fields(block, Access.CONSTANT)}
        self._now = constant | dict.fromkeys([*self._ports, *self._setters.values()], 0)
        self._latched = dict.fromkeys(self._now, 0)
        self.run(1)

    def read(self, address: int, count: int = 1) -> list[int]:
        """See Bus."""
        return [self._read(at) for at in addresses(address, count)]

    def write(self, address: int, words: Sequence[int]) -> None:
        """See Bus."""
        for at, word in zip(addresses(address, len(words)), words, strict=True):
            register = self._at(at)[0].register
            if not register.access.writes:
                raise AccessError(at, f"{register.name} cannot be written")
            written = register.unpack([word])
            if register.access is Access.TRIGGER:
                self.run(ACTING, written)
            else:
                self._now |= {name: self._now[name] & ~bit for name, bit in written.items()}

    def run(self, steps: int, triggers: Mapping[str, int] | None = None) -> None:
        """So many steps on, at most to the end of the pins; in the first one with these triggers.
        Raises ValueError at the end."""
        given = triggers or {}
        drive = {self._prefix + name: (1, [given.get(name, 0), 0]) for name in self._triggers}
        names = [name for ports in self._ports.values() for name, _ in ports]
        told = self._running.run(drive, steps, names)
        for field, ports in self._ports.items():
            before = self._now[field]
            waves = [(told[name].values, low) for name, low in ports]
            self._now[field] = sum(int(values[-1]) << low for values, low in waves)
            steady = all(values.size == 1 for values, _ in waves)
            if field in self._setters and not (steady and self._now[field] == before):
                self._now[self._setters[field]] = 1

    def _read(self, address: int) -> int:
        """One word; does what its gate does."""
        place, word = self._at(address)
        register, group = place.register, place.group
        if not register.access.reads:
            raise AccessError(address, f"{register.name} cannot be read")
        gate = group is not None and address == place.offset and register is group.registers[0]
        values = self._now
        if group is not None and group.gate is Gate.STROBE:
            if gate:
                self.run(ACTING, {STROBE: 1})
            self._wait(address)
        elif group is not None:
            if gate:
                self._latched |= {name: self._now[name] for name in _names(group)}
            values = self._latched
        return register.pack({name: values[name] for name in register.field_names})[word]

    def _wait(self, address: int) -> None:
        """Until no strobe is under way."""
        for _ in range(PATIENCE):
            if not self._now[BUSY]:
                return
            self.run(STROBING)
        raise NoAnswerError(address, "the strobe does not end")

    def _at(self, address: int) -> tuple[Place, int]:
        if address not in self._words:
            raise AccessError(address, "there is no register")
        return self._words[address]


def _require_served(block: Block) -> None:
    """Raises ValueError for what no function declares."""
    for register in block.registers:
        if register.access not in SERVED or register.access.sticky != bool(register.counters):
            raise ValueError(f"{register.name} must be as functions have it, to be modelled")
    for group in block.groups:
        if group.gate is Gate.TAKE:
            raise ValueError(f"{group.name} must be no stream, to be modelled")


def _words(block: Block) -> Iterator[tuple[int, tuple[Place, int]]]:
    """Each word's offset, its register's place, and which of its words it is."""
    for place in block.places:
        for offset in (place.offset, place.again):
            if offset is not None:
                for word in range(place.register.words):
                    yield offset + word * WORD_BYTES, (place, word)


def _fields(block: Block, access: Access) -> Iterator[Field]:
    """Those of registers of that access."""
    for register in block.registers:
        if register.access is access:
            yield from register.fields


def _names(group: Group) -> Iterator[str]:
    for register in group.registers:
        yield from register.field_names


def _ports(field: Field, prefix: str, there: Mapping[str, object]) -> list[tuple[str, int]]:
    """The outputs that carry a field, and from which of its bits on. Raises ValueError."""
    names = {name.removeprefix(prefix).replace(".", "_"): name for name in there}
    if field.width <= MAX_WIDTH:
        wanted = {field.name: 0}
    else:
        lows = range(0, field.width, MAX_WIDTH)
        wanted = {f"{field.name}_{low // MAX_WIDTH}": low for low in lows}
    if missing := wanted.keys() - names.keys():
        raise ValueError(f"no output for {', '.join(sorted(missing))}")
    return [(names[name], low) for name, low in wanted.items()]
