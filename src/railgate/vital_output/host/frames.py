"""The command frame as a CPU makes it, written apart from the specification's Layout and Check.

Ref: source 004, paragraphs 14 to 18; DRV-1, DRV-2, DRV-4.
"""

from __future__ import annotations

from functools import cache

from railgate.vital_output.spec import Config

__all__ = ["crc", "encode"]

TOP = 1 << 31
WORD = (1 << 32) - 1


def encode(
    config: Config, board: int, time: int, sequence: int, image: int, acknowledge: int = 0
) -> bytes:
    """A frame for FPGA `board` + 1 in the system cycle `time`, as it is sent.

    board: 0 or 1, which of config.boards. time, sequence: modulo 2³². image, acknowledge: bit i is
    output i's. Board and time are in the CRC alone. Raises ValueError.
    """
    if board not in (0, 1):
        raise ValueError(f"board must be 0 or 1, not {board}")
    size = -(-config.outputs // 8)
    fields = [(sequence & WORD).to_bytes(4, "big")]
    for name, bits in (("image", image), ("acknowledge", acknowledge)):
        if not 0 <= bits < 1 << config.outputs:
            most = (1 << config.outputs) - 1
            raise ValueError(f"{name} must be between 0 and {most:#x}, not {bits:#x}")
        fields.append(bits.to_bytes(size, "big"))
    sent = b"".join(fields)
    implicit = config.boards[board].to_bytes(4, "big") + (time & WORD).to_bytes(4, "big")
    return sent + crc(config.polynomial, implicit + sent).to_bytes(4, "big")


def crc(polynomial: int, data: bytes) -> int:
    """The CRC of 32 bits over whole bytes, a byte at a time: the register starts as all ones, the
    most significant bit goes first, nothing is added at the end."""
    table = _table(polynomial)
    register = WORD
    for byte in data:
        register = (register << 8) & WORD ^ table[register >> 24 ^ byte]
    return register


@cache
def _table(polynomial: int) -> tuple[int, ...]:
    """What eight steps make of each byte at the register's top."""
    table = []
    for byte in range(256):
        register = byte << 24
        for _ in range(8):
            register = (register << 1) & WORD ^ (polynomial if register & TOP else 0)
        table.append(register)
    return tuple(table)
