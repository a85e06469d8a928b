"""A board on a serial line, by the protocol of `railgate.registers.gateware.uart`.

Written from that package's docstring, not from its gateware.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from os import strerror
from struct import pack, unpack_from
from types import TracebackType
from typing import Self
from zlib import crc32

import serial

from railgate.registers.host.bus import AccessError, NoAnswerError, addresses
from railgate.registers.register import WORD_BYTES

__all__ = ["UartBus", "framed"]

END, ESCAPE = b"\xc0", b"\xdb"
ESCAPED = ((ESCAPE, b"\xdb\xdd"), (END, b"\xdb\xdc"))
HELLO, READ, WRITE = range(3)
DONE, BUS_ERROR, REFUSED = range(3)
NUMBERS = 1 << 16
AROUND = 4
"""Words of a frame beside those that are read or written, and as many for both its borders."""
BITS = 10
"""Of a byte on the line."""
PIECE = 4096


class UartBus:
    """A bridge on a serial port, as /dev/ttyUSB0, at `baud` bits a second.

    A request without a good answer after `wait_s`, and what the line takes, is sent again, `tries`
    times in all: the bridge makes each once, whichever way is lost or spoilt (ODO-7). Raises
    ValueError where the port cannot be opened, and NoAnswerError where no bridge answers.
    """

    def __init__(self, port: str, baud: int, wait_s: float = 0.5, tries: int = 5) -> None:
        self._wait_s, self._tries = wait_s, tries
        self._byte_s = BITS / baud
        self._number = 0
        try:
            self._port = serial.Serial(port, baud, timeout=0, exclusive=True)
        except (OSError, ValueError) as error:
            number = getattr(error, "errno", None)
            told = strerror(number) if number else str(error)
            raise ValueError(f"{port} cannot be opened at {baud} baud: {told}") from None
        try:
            _, self._most, _ = self._ask(HELLO, 0, 0)
        except NoAnswerError:
            self.close()
            raise

    def read(self, address: int, count: int = 1) -> list[int]:
        """See Bus."""
        words: list[int] = []
        for first, size in self._pieces(address, count):
            status, done, found = self._ask(READ, first, size)
            _require(status, first, done)
            words += found
        return words

    def write(self, address: int, words: Sequence[int]) -> None:
        """See Bus."""
        for first, size in self._pieces(address, len(words)):
            at = (first - address) // WORD_BYTES
            status, done, _ = self._ask(WRITE, first, size, words[at : at + size])
            _require(status, first, done)

    def _pieces(self, address: int, count: int) -> Iterator[tuple[int, int]]:
        """First address and size of each request."""
        found = addresses(address, count)
        for at in range(0, count, self._most):
            yield found[at], min(self._most, count - at)

    def _ask(
        self, operation: int, address: int, count: int, words: Sequence[int] = ()
    ) -> tuple[int, int, list[int]]:
        """Status, count and words of the answer to one request. Raises NoAnswerError."""
        self._number = (self._number + 1) % NUMBERS
        head = pack("<HBBI", self._number, operation, count, address)
        request = framed(head + pack(f"<{len(words)}I", *words))
        longest = len(request) + 2 * WORD_BYTES * (count + AROUND)
        heard = False
        for _ in range(self._tries):
            self._send(address, request)
            until = time.monotonic() + self._wait_s + longest * self._byte_s
            for frame in self._frames(address, until):
                heard = True
                answer = _answer(frame, count if operation == READ else 0)
                if answer is not None and answer[0] == self._number:
                    return answer[1:]
        told = "no good answer, the CRC is wrong" if heard else "no answer"
        raise NoAnswerError(address, f"{told} after {self._tries} tries")

    def _send(self, address: int, request: bytes) -> None:
        try:
            self._port.write(request)
        except OSError as error:
            raise NoAnswerError(address, f"the port is gone: {error}") from None

    def _frames(self, address: int, until: float) -> Iterator[bytes]:
        """What comes between two END until a time."""
        rest = b""
        while (left := until - time.monotonic()) > 0:
            try:
                self._port.timeout = left
                rest += self._port.read(max(1, min(self._port.in_waiting, PIECE)))
            except OSError as error:
                raise NoAnswerError(address, f"the port is gone: {error}") from None
            *frames, rest = rest.split(END)
            yield from filter(None, frames)

    def close(self) -> None:
        """Let the port go."""
        self._port.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


def framed(body: bytes) -> bytes:
    """Whole words as they are sent: with their CRC, between two END."""
    body += pack("<I", crc32(body))
    for plain, code in ESCAPED:
        body = body.replace(plain, code)
    return END + body + END


def _answer(frame: bytes, most: int) -> tuple[int, int, int, list[int]] | None:
    """Number, status, count and words of an answer of at most so many words; None where it is none,
    or spoilt."""
    body = frame
    for plain, code in reversed(ESCAPED):
        body = body.replace(code, plain)
    if len(body) < 2 * WORD_BYTES or len(body) % WORD_BYTES:
        return None
    data, check = body[:-WORD_BYTES], unpack_from("<I", body, len(body) - WORD_BYTES)
    number, status, count = unpack_from("<HBB", data)
    words = unpack_from(f"<{len(data) // WORD_BYTES - 1}I", data, WORD_BYTES)
    if check != (crc32(data),) or len(words) != min(count, most):
        return None
    return number, status, count, list(words)


def _require(status: int, address: int, done: int) -> None:
    """Raises AccessError unless all of a request has been done."""
    if status == BUS_ERROR:
        raise AccessError(address + done * WORD_BYTES, "the bus tells an error")
    if status != DONE:
        raise AccessError(address, "the bridge refuses the access")
