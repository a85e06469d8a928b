"""The registers of a function, and the map of an FPGA, from what gateware and host are made of."""

from __future__ import annotations

from collections.abc import Iterator

from railgate.registers import Block, Gate, Group, Register
from railgate.unit.config import Unit
from railgate.unit.registers import registers
from sheets.functions import function
from sheets.markdown import table

__all__ = ["blocks", "map_of"]

GATES = {
    Gate.LATCH: "a read of its first word copies all fields as they are in one tick",
    Gate.TAKE: "a read of its first word takes the next entry of the stream",
    Gate.STROBE: "a read of its first word strobes the function and waits for its fields",
}


def blocks(name: str) -> str:
    """Tables of a function's registers with its default configuration. Raises ValueError."""
    of = function(name)
    block = of.registers(of.config)
    alone = [each for each in block.entries if isinstance(each, Register)]
    parts = [table(HEADER, _rows(block, alone))]
    for group in block.groups:
        parts.append(f"**`{group.name}`**, {group.description}: {GATES[group.gate]}.\n")
        parts.append(table(HEADER, _rows(block, group.registers)))
    return "\n".join(parts)


HEADER = ("offset", "register", "access", "bits", "field", "meaning")


def _rows(block: Block, registers_: list[Register] | tuple[Register, ...]) -> Iterator[list[str]]:
    """A row for each field, the first of a register with what is the register's."""
    for register in registers_:
        place = block.place(register.name)
        offset = f"`{place.offset:#05x}`"
        if place.again is not None:
            offset += f", `{place.again:#05x}`"
        head = [offset, f"`{register.name}`", register.access.value]
        for field, shift in zip(register.fields, register.shifts, strict=True):
            named = "" if field.name == register.name else f"`{field.name}`"
            high = shift + field.width - 1
            bits = f"{high}:{shift}" if field.width > 1 else f"{shift}"
            values = register.values.get(field.name)
            meaning = field.meaning + (f", {field.unit}" if field.unit else "")
            if values and f"see {values.__name__}" not in meaning:
                meaning += f"; see {values.__name__}"
            yield [*head, bits, named, meaning]
            head = ["", "", ""]


def map_of(fpga: str) -> str:
    """The blocks of an FPGA of the default unit at their addresses. Raises ValueError."""
    map_ = registers(Unit(), int(fpga))
    rows = [
        (f"`{base:#06x}`", f"`{block.name}`", block.description, _gates(block))
        for base, block in sorted(map_.blocks.items())
    ]
    return table(("address", "block", "what it is", "groups read as of one tick"), rows)


def _gates(block: Block) -> str:
    return ", ".join(f"`{_.name}`, {_.words} words" for _ in block.groups if isinstance(_, Group))
