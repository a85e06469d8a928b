"""A board's registers in this machine's memory: `/dev/uio*`, `/dev/mem`."""

from __future__ import annotations

import mmap
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Self

from railgate.registers.host.bus import AccessError, addresses
from railgate.registers.register import WORD_BYTES

__all__ = ["MemoryBus"]


class MemoryBus:
    """A file that is mapped: each word is one aligned access of 32 bits, in the machine's order of
    bytes.

    base: of the registers in the file, of /dev/mem their physical address. size: bytes from there
    on. What a bus tells of an error is not seen here: the machine does with it what it does, which
    may be to end the process. Raises ValueError where the file cannot be mapped.
    """

    def __init__(self, path: Path, size: int, base: int = 0) -> None:
        skipped = base % mmap.ALLOCATIONGRANULARITY
        try:
            with path.open("r+b", buffering=0) as file:
                self._map = mmap.mmap(file.fileno(), skipped + size, offset=base - skipped)
        except (OSError, ValueError, OverflowError) as error:
            told = error.strerror if isinstance(error, OSError) else error
            raise ValueError(f"{path} cannot be mapped: {told}") from None
        self._bytes = memoryview(self._map)[skipped:]
        self._words = self._bytes.cast("I")

    def read(self, address: int, count: int = 1) -> list[int]:
        """See Bus."""
        return [self._words[at // WORD_BYTES] for at in self._inside(address, count)]

    def write(self, address: int, words: Sequence[int]) -> None:
        """See Bus."""
        for at, word in zip(self._inside(address, len(words)), words, strict=True):
            self._words[at // WORD_BYTES] = word

    def _inside(self, address: int, count: int) -> range:
        found = addresses(address, count)
        if found.stop > self._bytes.nbytes:
            raise AccessError(address, "not all of it is mapped")
        return found

    def close(self) -> None:
        """Unmap it."""
        self._words.release()
        self._bytes.release()
        self._map.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
