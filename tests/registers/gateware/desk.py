"""A host at the other end of the serial line, by the text of the protocol alone."""

from __future__ import annotations

import zlib
from typing import Any, NamedTuple

__all__ = ["Answer", "Host", "frame", "request", "unframed"]

END, ESCAPE = b"\xc0", b"\xdb"
HELLO, READ, WRITE = 0, 1, 2


class Answer(NamedTuple):
    """The words of an answer."""

    number: int
    status: int
    count: int
    words: tuple[int, ...]


def frame(content: bytes) -> bytes:
    """A frame of these bytes, as RFC 1055 has it."""
    escaped = content.replace(ESCAPE, ESCAPE + b"\xdd").replace(END, ESCAPE + b"\xdc")
    return END + escaped + END


def unframed(line: bytes) -> list[bytes]:
    """The contents of all frames on a line."""
    parts = [part for part in line.split(END) if part]
    return [part.replace(ESCAPE + b"\xdc", END).replace(ESCAPE + b"\xdd", ESCAPE) for part in parts]


def checked(content: bytes) -> bytes:
    return content + zlib.crc32(content).to_bytes(4, "little")


def request(
    number: int, operation: int, address: int = 0, count: int = 0, words: tuple[int, ...] = ()
) -> bytes:
    """A request's frame; count: of the words, where they are not told."""
    head = number.to_bytes(2, "little") + bytes((operation, count or len(words)))
    body = b"".join(word.to_bytes(4, "little") for word in (address, *words))
    return frame(checked(head + body))


def answer(content: bytes) -> Answer:
    assert zlib.crc32(content[:-4]) == int.from_bytes(content[-4:], "little")
    assert len(content) % 4 == 0
    words = (int.from_bytes(content[at : at + 4], "little") for at in range(4, len(content) - 4, 4))
    return Answer(int.from_bytes(content[:2], "little"), content[2], content[3], tuple(words))


class Host:
    """Sends bytes and hears them, in Amaranth's simulator; bit_ticks may be off the bridge's."""

    def __init__(self, pins: Any, bit_ticks: float) -> None:
        self._pins, self._bit_ticks = pins, bit_ticks
        self._heard = bytearray()
        self._ctx: Any = None

    async def listens(self, ctx: Any) -> None:
        """A test bench in the background: takes down what the bridge sends."""
        while True:
            while ctx.get(self._pins.tx):
                await ctx.tick()
            bits = []
            for at in range(10):
                await self._pass(ctx, at + 0.5, at - 0.5 if at else 0)
                bits.append(ctx.get(self._pins.tx))
            assert (bits[0], bits[9]) == (0, 1), "start and stop bit"
            self._heard.append(sum(bit << at for at, bit in enumerate(bits[1:9])))

    async def _pass(self, ctx: Any, until: float, since: float) -> None:
        for _ in range(int(until * self._bit_ticks) - int(since * self._bit_ticks)):
            await ctx.tick()

    async def begins(self, ctx: Any) -> None:
        """The line rests, and is the host's."""
        self._ctx = ctx
        ctx.set(self._pins.rx, 1)
        await self._pass(ctx, 3, 0)

    async def send(self, line: bytes) -> None:
        for byte in line:
            for at, bit in enumerate((0, *(byte >> at & 1 for at in range(8)), 1)):
                self._ctx.set(self._pins.rx, bit)
                await self._pass(self._ctx, at + 1, at)

    async def hear(self, patience_bits: int = 25) -> bytes:
        """The bytes until nothing has come for so long."""
        before = -1
        while before != len(self._heard):
            before = len(self._heard)
            await self._pass(self._ctx, patience_bits, 0)
        heard = bytes(self._heard)
        self._heard.clear()
        return heard

    async def asks(self, line: bytes) -> list[Answer]:
        """The answers to what is sent."""
        await self.send(line)
        return [answer(content) for content in unframed(await self.hear())]
