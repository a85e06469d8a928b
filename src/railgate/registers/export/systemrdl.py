"""The map as SystemRDL 2.0, from which other tools make headers, pages and more.

No register of the description is wider than what the bus moves at once: of a wider one each word
is a register, see `pieces`. A group is a register file that is there twice, as `<group>` and as
`<group>_again`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from enum import IntEnum
from textwrap import indent

from railgate.registers.block import Block, Gate, Group
from railgate.registers.export.pieces import Piece, pieces, word_name
from railgate.registers.map import Map
from railgate.registers.register import WORD_BITS, WORD_BYTES, Access, Register

__all__ = ["KEYWORDS", "systemrdl"]

RESERVED = (
    "abstract accesstype addressingtype addrmap alias all alternate bit boolean bothedge byte "
    "compact component componentwidth constraint default encode enum external false field "
    "fullalign hw inside int internal level longint mem na negedge nonsticky number onreadtype "
    "onwritetype posedge precedencetype property r rclr real ref reg regalign regfile rset ruser "
    "rw rw1 shortint shortreal signal signed string struct sw this true type unsigned w w1 wclr "
    "with within woclr woset wot wr wset wuser wzc wzs wzt"
)
KEYWORDS = frozenset(RESERVED.split())
"""What is a name only behind a backslash."""

HEAD = """\
property is_signed { type = boolean; component = field; };
"""
ACCESS = {
    Access.CONSTANT: "sw = r; hw = na;",
    Access.READ: "sw = r; hw = w;",
    Access.READ_TO_CLEAR: "sw = r; onread = rclr; hw = w; stickybit;",
    Access.WRITE_ONE_TO_CLEAR: "sw = rw; onwrite = woclr; hw = w; stickybit;",
    Access.READ_WRITE: "sw = rw; hw = r;",
    Access.TRIGGER: "sw = w; hw = r; singlepulse;",
}
GATES = {
    Gate.LATCH: "reading the first word latches all of them",
    Gate.TAKE: "reading the first word takes the oldest entry and latches it",
    Gate.STROBE: "reading the first word strobes the function, and all are as of that strobe",
}


def systemrdl(map_: Map) -> str:
    """The whole map: one address map, in it one of each block.

    Raises ValueError where a field to trigger has several bits, for which SystemRDL has no words.
    """
    parts = [_described(map_.name, map_.description), f"default regwidth = {WORD_BITS};"]
    parts += (_block(block, base) for base, block in map_.blocks.items())
    return f"{HEAD}\naddrmap {_name(map_.name)} {_braced(parts)};\n"


def _block(block: Block, base: int) -> str:
    parts = [_described(block.name, block.description)]
    kinds = {kind for each in block.registers for kind in each.values.values()}
    parts += (_enumeration(kind) for kind in sorted(kinds, key=str) if issubclass(kind, IntEnum))
    for place in block.places:
        if place.group is None:
            parts += _words(place.register, place.offset)
    for group in block.groups:
        parts += _group(group, block.place(group.name).offset)
    return f"addrmap {_braced(parts)} {_name(block.name)} @ {base:#x};"


def _enumeration(kind: type[IntEnum]) -> str:
    members = [f"{_name(each.name.lower())} = {each.value};" for each in kind]
    return f"enum {_name(kind.__name__)} {_braced(members)};"


def _group(group: Group, offset: int) -> Iterator[str]:
    """Its registers, and both their places."""
    told = f"{group.description}; {GATES[group.gate]}, but not where they are read again"
    parts, size = [f"desc = {_quoted(told)};"], 0
    for register in group.registers:
        parts += _words(register, size)
        size += register.words * WORD_BYTES
    yield f"regfile {group.name}_words {_braced(parts)};"
    yield f"{group.name}_words {_name(group.name)} @ {offset:#x};"
    yield f"{group.name}_words {group.name}_again @ {offset + size:#x};"


def _words(register: Register, offset: int) -> Iterator[str]:
    found = list(pieces(register))
    for word in range(register.words):
        parts = [_field(piece, register.access) for piece in found if piece.word == word]
        name = _name(word_name(register, word))
        yield f"reg {_braced(parts)} {name} @ {offset + word * WORD_BYTES:#x};"


def _field(piece: Piece, access: Access) -> str:
    if access is Access.TRIGGER and piece.width > 1:
        raise ValueError(f"{piece.name} must have 1 bit to be described, not {piece.width}")
    parts = [f"desc = {_quoted(piece.meaning)};", ACCESS[access]]
    if piece.signed:
        parts.append("is_signed;")
    if piece.kind is not None:
        parts.append(f"encode = {_name(piece.kind.__name__)};")
    bits = f"[{piece.low + piece.width - 1}:{piece.low}]"
    reset = f"{piece.width}'h{piece.start:x}"
    return f"field {{ {' '.join(parts)} }} {_name(piece.name)}{bits} = {reset};"


def _described(name: str, description: str) -> str:
    return f"name = {_quoted(name)};\ndesc = {_quoted(description)};"


def _braced(parts: Iterable[str]) -> str:
    return "{\n" + indent("\n".join(parts), "    ") + "\n}"


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _name(name: str) -> str:
    return f"\\{name}" if name in KEYWORDS else name
