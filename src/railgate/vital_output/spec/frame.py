"""The command frame and the message of the cross-link: fields in their order, CRCs, masks.

A frame or message is its fields one after the other, the first one in the most significant bits,
each padded with zeros in front to its `width`. Ref: source 004, paragraphs 14 to 18.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING

from railgate.check import Check
from railgate.field import Field

if TYPE_CHECKING:
    from railgate.vital_output.spec.config import Config

__all__ = ["CRC_BITS", "Layout", "bits", "mask", "pack", "unpack"]

CRC_BITS = 32
ID_BITS = 32
TIME_BITS = 32
SEQUENCE_BITS = 32
BOOT_BITS = 16
NUMBER_BITS = 8
DIGEST_BITS = 32


class Layout:
    """How command frames and cross-link messages of one configuration are laid out.

    implicit: board and time, which come before a frame's fields in its CRC and are not sent.
    frame: the fields that are, `crc` the last. message: those of the cross-link, `crc` the last.
    check: of the frame, over implicit and frame fields but crc.
    """

    def __init__(self, config: Config) -> None:
        outputs = config.outputs
        self._link_polynomial = config.link_polynomial
        padded = 8 * -(-outputs // 8)
        self.implicit = (
            Field("board", ID_BITS, "the FPGA's that the frame is for"),
            Field("time", TIME_BITS, "index of the system cycle in which it is sent", "cycles"),
        )
        self.frame = (
            Field("sequence", SEQUENCE_BITS, "one more in each frame, modulo its width"),
            Field("image", padded, "bit i commands output i; bits beyond the outputs are 0"),
            Field("acknowledge", padded, "bit i acknowledges output i by its rise; likewise"),
            Field("crc", CRC_BITS, "over board, time and all fields before"),
        )
        self.message = (
            Field("number", NUMBER_BITS, "one more in each message, modulo its width"),
            Field("boot", BOOT_BITS, "another one after each start of the sender"),
            Field("digest", DIGEST_BITS, "of the sender's configuration"),
            Field("test", 2, "of the shut-off paths, see TestPhase"),
            Field("codes", 2 * outputs, "of output i in bits 2i and 2i + 1, see Code"),
            Field("carries", 1, "a frame was accepted since reset"),
            Field("passed", 1, "that frame has passed the sender's vote"),
            Field("sequence", SEQUENCE_BITS, "of the frame last accepted, 0 before the first"),
            Field("image", outputs, "of that frame"),
            Field("acknowledge", outputs, "of that frame"),
            Field("frame_crc", CRC_BITS, "of that frame, as the CPU has sent it"),
            Field("crc", CRC_BITS, "over all fields before, register begun as the sender's board"),
        )
        self.check = Check(
            width=CRC_BITS, polynomial=config.polynomial, initial=(1 << CRC_BITS) - 1
        )

    def message_check(self, board: int) -> Check:
        """The check of messages that the FPGA with this ID sends: others' messages, and its own
        that come back, do not pass."""
        return Check(width=CRC_BITS, polynomial=self._link_polynomial, initial=board)

    @cached_property
    def frame_bytes(self) -> int:
        return bits(self.frame) // 8

    @cached_property
    def implicit_bytes(self) -> int:
        return bits(self.implicit) // 8

    @cached_property
    def message_bits(self) -> int:
        """Of one message on the line, with its start bit."""
        return 1 + bits(self.message)

    def crc(self, board: int, time: int, values: Mapping[str, int]) -> int:
        """The CRC of a frame with these values of its fields, for this board in this cycle."""
        covered = (*self.implicit, *self.frame[:-1])
        values = {"board": board, "time": time & (1 << TIME_BITS) - 1, **values}
        return self.check.of(pack(covered, values), bits(covered))


def bits(fields: Sequence[Field]) -> int:
    """The bits of these fields together."""
    return sum(field.width for field in fields)


def pack(fields: Sequence[Field], values: Mapping[str, int]) -> int:
    """The fields as one number, the first one most significant. Raises ValueError."""
    packed = 0
    for field in fields:
        value = values[field.name]
        if not 0 <= value < 1 << field.width:
            raise ValueError(
                f"{field.name} must be between 0 and {(1 << field.width) - 1}, not {value}"
            )
        packed = packed << field.width | value
    return packed


def unpack(fields: Sequence[Field], packed: int) -> dict[str, int]:
    """What `pack` has packed."""
    values: dict[str, int] = {}
    for field in reversed(fields):
        values[field.name] = packed & (1 << field.width) - 1
        packed >>= field.width
    return {field.name: values[field.name] for field in fields}


def mask(layout: Layout, board: int, number: int) -> int:
    """What replaces the board ID in step 2 so that the frame's CRC differs in bit `number` alone.

    A CRC is linear: to invert the ID's bits δ changes it by δ · x^n mod P, n the bits from the ID's
    last one to the CRC's end; so δ is bit `number` after n steps of the register backwards
    (DRV-2).
    """
    polynomial = layout.check.polynomial | 1 << CRC_BITS
    delta = 1 << number
    steps = bits((*layout.implicit, *layout.frame[:-1]))
    for _ in range(steps):
        delta = (delta ^ (polynomial if delta & 1 else 0)) >> 1
    return board ^ delta
