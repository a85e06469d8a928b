"""A bank as its contract tells it, tick by tick, without the gateware."""

from __future__ import annotations

from typing import NamedTuple

from railgate.registers import Access, Block, Gate, Group, Register

__all__ = ["Reference", "Request"]

DONE_AFTER = 2
"""Ticks from a request to its access, if it does not wait."""


class Request(NamedTuple):
    """A write where there is data; else a read."""

    address: int
    data: int | None = None
    strobes: int = 15


class Reference:
    """`tick` takes the inputs of one tick, and tells the outputs of it."""

    def __init__(self, block: Block) -> None:
        self._block = block
        self._request: Request | None = None
        self._since = 0
        self._answer: tuple[int, int] | None = None
        self._held = {each.name: 0 for each in block.registers if each.access.sticky}
        self._written = {
            field.name: field.start
            for each in block.registers
            if each.access is Access.READ_WRITE
            for field in each.fields
        }
        self._latched: dict[str, dict[str, int]] = {group.name: {} for group in block.groups}
        self._counters = {name: field.start for name, field in block.fields.items()}

    def tick(self, inputs: dict[str, int], request: Request | None) -> dict[str, int]:
        """The outputs: `ready`, `valid`, `data`, `error`, and those of the fields."""
        data, error = self._answer or (0, 0)
        told = {"valid": int(self._answer is not None), "data": data, "error": error}
        told |= {"ready": int(self._request is None)} | dict.fromkeys(self._pulses(), 0)
        told |= self._written
        self._answer = None
        cleared: dict[str, int] = {}
        if self._request is None:
            if request:
                self._request, self._since = request, 0
        else:
            self._since += 1
            group = self._group(self._request)
            if self._since == 1 and group and self._request.data is None:
                told |= self._gate(group, inputs)
            waits = group and group.gate is Gate.STROBE and inputs["busy"]
            if self._since >= DONE_AFTER and not (waits and self._request.data is None):
                self._answer = self._access(self._request, inputs, told, cleared)
                self._request = None
        for register in self._block.registers:
            if register.access.sticky:
                held = self._held[register.name] & ~cleared.get(register.name, 0)
                self._held[register.name] = held | self._sets(register, inputs)
        self._counters |= inputs
        return told

    def _pulses(self) -> list[str]:
        names = [
            field.name
            for each in self._block.registers
            if each.access is Access.TRIGGER
            for field in each.fields
        ]
        for group in self._block.groups:
            names += {Gate.STROBE: ["strobe"], Gate.TAKE: [f"{group.name}_ready"]}.get(
                group.gate, []
            )
        return names

    def _found(self, request: Request) -> tuple[Register, int] | None:
        """The register, and which of its words."""
        word = request.address // 4 * 4
        for place in self._block.places:
            for first in (place.offset, place.again):
                if first is not None and 0 <= word - first < 4 * place.register.words:
                    return place.register, (word - first) // 4
        return None

    def _group(self, request: Request) -> Group | None:
        found = self._found(request)
        for group in self._block.groups:
            if found and found[0] in group.registers:
                return group
        return None

    def _gate(self, group: Group, inputs: dict[str, int]) -> dict[str, int]:
        """The first word of the group's first place is read."""
        assert self._request
        if self._request.address // 4 * 4 != self._block.place(group.name).offset:
            return {}
        if group.gate is Gate.STROBE:
            return {"strobe": 1}
        fields = [field.name for each in group.registers for field in each.fields]
        self._latched[group.name] = {name: inputs[name] for name in fields}
        return {f"{group.name}_ready": 1} if group.gate is Gate.TAKE else {}

    def _access(
        self,
        request: Request,
        inputs: dict[str, int],
        told: dict[str, int],
        cleared: dict[str, int],
    ) -> tuple[int, int]:
        """Data and error of the answer."""
        found = self._found(request)
        if not found:
            return 0, 1
        register, word = found
        access = register.access
        if request.data is None:
            if access is Access.READ_TO_CLEAR:
                cleared[register.name] = ~0
            return (self._word(register, word, inputs), 0) if access.reads else (0, 1)
        if not access.writes:
            return 0, 1
        mask = sum(0xFF << 8 * lane for lane in range(4) if request.strobes >> lane & 1)
        data = request.data & mask
        if access is Access.WRITE_ONE_TO_CLEAR:
            cleared[register.name] = data
        elif access is Access.TRIGGER:
            told |= {name: told[name] | bits for name, bits in self._cut(register, data).items()}
        else:
            before = register.pack({name: self._written[name] for name in register.field_names})
            self._written |= self._cut(register, before[0] & ~mask | data)
        return 0, 0

    def _cut(self, register: Register, word: int) -> dict[str, int]:
        return register.unpack([word & (1 << register.width) - 1])

    def _word(self, register: Register, word: int, inputs: dict[str, int]) -> int:
        if register.access.sticky:
            return self._held[register.name]
        values = {field.name: field.start for field in register.fields}
        for source in (inputs, self._written):
            values |= {name: source[name] for name in register.field_names if name in source}
        for group in self._block.groups:
            if register in group.registers and group.gate is not Gate.STROBE:
                latched = self._latched[group.name]
                values = {name: latched.get(name, 0) for name in register.field_names}
        return register.pack(values)[word]

    def _sets(self, register: Register, inputs: dict[str, int]) -> int:
        if not register.counters:
            return register.pack({name: inputs[name] for name in register.field_names})[0]
        return sum(
            (inputs[name] != self._counters[name]) << at
            for at, name in enumerate(register.counters)
        )
