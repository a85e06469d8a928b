"""What every bus to a board is to those who drive it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from railgate.registers.register import WORD_BYTES

__all__ = ["AccessError", "Bus", "BusError", "NoAnswerError", "addresses"]


class BusError(Exception):
    """An access that came to nothing. address: of the word, or of the first one of several."""

    def __init__(self, address: int, reason: str) -> None:
        super().__init__(f"{reason}, at address {address:#x}")
        self.address = address


class AccessError(BusError):
    """The bus told an error: there is nothing to read or to write at the address."""


class NoAnswerError(BusError):
    """Nothing has answered in time, or nothing that could be understood."""


class Bus(Protocol):
    """Reads and writes words of 32 bits at byte addresses, multiples of 4.

    Words are accessed one after the other from the first one on, each once, whatever is lost on
    the way (ODO-7). Both raise BusError: then words before the one that failed have been accessed;
    and ValueError for what can be no access.
    """

    def read(self, address: int, count: int = 1) -> list[int]:
        """So many words from an address on."""

    def write(self, address: int, words: Sequence[int]) -> None:
        """These words from an address on."""


def addresses(address: int, count: int) -> range:
    """Those of an access. Raises ValueError unless they can be."""
    if address < 0 or address % WORD_BYTES:
        raise ValueError(f"address must be a multiple of {WORD_BYTES}, not {address:#x}")
    if count < 1:
        raise ValueError(f"an access must be to at least 1 word, not {count}")
    return range(address, address + count * WORD_BYTES, WORD_BYTES)
