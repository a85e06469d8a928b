"""The numbers of the serial line's protocol, which is told in this package's docstring."""

from __future__ import annotations

from enum import IntEnum

from amaranth.lib import data
from amaranth.lib.crc.catalog import CRC32_ISO_HDLC

__all__ = [
    "ANSWER",
    "BAUD",
    "BYTE",
    "CRC",
    "END",
    "ESCAPE",
    "ESCAPED",
    "REQUEST",
    "Operation",
    "Status",
]

BAUD = 115_200
"""Of a board's line, where it is not told otherwise, as of `railgate attach`."""
BYTE = 8
END, ESCAPE = 0xC0, 0xDB
ESCAPED = {END: 0xDC, ESCAPE: 0xDD}
"""What is sent after ESCAPE in place of these bytes."""

CRC = CRC32_ISO_HDLC(data_width=BYTE)

REQUEST = data.StructLayout({"number": 16, "operation": 8, "count": 8})
"""The first word of a request."""
ANSWER = data.StructLayout({"number": 16, "status": 8, "count": 8})
"""The first word of an answer."""


class Operation(IntEnum):
    """What a request wants."""

    HELLO = 0
    READ = 1
    WRITE = 2


class Status(IntEnum):
    """What has become of it."""

    DONE = 0
    BUS_ERROR = 1
    REFUSED = 2
