"""The register map: blocks at their addresses.

Words have 32 bits, addresses count bytes. A block is a function's, declared beside it and made
from its configuration, so that no field is written twice (SYS-1); gateware, host, header and
documents are made from the block. Every register and every field has a name of its own in its
block, and the gateware's port is called as the field.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from railgate.registers.block import Block, require_unique

__all__ = ["Map"]

ADDRESS_BITS = 32


@dataclass(frozen=True, kw_only=True)
class Map:
    """Blocks at their base addresses, by base.

    Raises ValueError where two overlap, have the same name, or where a base is no multiple of its
    block's size.
    """

    name: str
    description: str
    blocks: Mapping[int, Block]

    def __post_init__(self) -> None:
        require_unique(self.name, [block.name for block in self.blocks.values()])
        end, before = 0, ""
        for base, block in sorted(self.blocks.items(), key=lambda each: each[0]):
            if base % block.size:
                raise ValueError(
                    f"the base of {block.name} must be a multiple of {block.size:#x}, not {base:#x}"
                )
            if base < end:
                raise ValueError(f"{block.name} at {base:#x} must be clear of {before}")
            end, before = base + block.size, block.name
        if end > 1 << ADDRESS_BITS:
            raise ValueError(f"{self.name} must end within {ADDRESS_BITS} address bits")

    @classmethod
    def of(cls, name: str, description: str, blocks: Iterable[Block]) -> Map:
        """The blocks one after the other, each at the next address that it can be at."""
        placed: dict[int, Block] = {}
        end = 0
        for block in blocks:
            base = -(-end // block.size) * block.size
            placed[base] = block
            end = base + block.size
        return cls(name=name, description=description, blocks=placed)

    @property
    def size(self) -> int:
        """Bytes from address 0 to the end of the last block."""
        return max((base + block.size for base, block in self.blocks.items()), default=0)

    def address(self, block: str, name: str, *, again: bool = False) -> int:
        """Of a register, or of a group's first one; `again`: of its second place.
        Raises ValueError."""
        for base, each in self.blocks.items():
            if each.name == block:
                place = each.place(name)
                offset = place.again if again else place.offset
                if offset is None:
                    raise ValueError(f"{name} is in no group, it has no second place")
                return base + offset
        told = ", ".join(each.name for each in self.blocks.values())
        raise ValueError(f'no block "{block}" in {self.name}; there are: {told}')
