"""Parities and CRCs: what is computed over the bits of a word, a frame or a message."""

from __future__ import annotations

from dataclasses import dataclass

from railgate.bounds import require

__all__ = ["Check"]


@dataclass(frozen=True, kw_only=True)
class Check:
    """A parity or CRC field of `width` bits over bits before it.

    The register starts as `initial`; each bit, the most significant first, shifts it left and, if
    the bit shifted out differs from the bit, adds `polynomial` (without its leading term); at the
    end it is the field, xor `final`. A parity is the CRC of one bit. Raises ValueError.
    """

    width: int
    polynomial: int
    initial: int = 0
    final: int = 0

    def __post_init__(self) -> None:
        require(self, ("width", 1, 64))
        top = (1 << self.width) - 1
        require(self, ("polynomial", 1, top), ("initial", 0, top), ("final", 0, top))

    def of(self, bits: int, count: int) -> int:
        """The field that belongs to the `count` bits of the number `bits`."""
        register, top = self.initial, 1 << (self.width - 1)
        for at in reversed(range(count)):
            out = bool(register & top) != bool(bits >> at & 1)
            register = (register << 1) & (2 * top - 1) ^ (self.polynomial if out else 0)
        return register ^ self.final
