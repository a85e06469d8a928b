"""The bus that bridges, decoder, crossing and banks share."""

from __future__ import annotations

from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

from railgate.registers.register import WORD_BITS, WORD_BYTES

__all__ = ["address_bits", "bus_signature"]


def address_bits(size: int) -> int:
    """Of an address in so many bytes."""
    return (size - 1).bit_length()


def bus_signature(address_bits: int) -> wiring.Signature:
    """One access at a time, from the requester's side.

    request: out, a stream: address, in bytes, of which the lowest two bits are ignored: an access
    is to a whole word; write, 1 bit; data, 32 bits, and strobes, one bit a byte, of a write: a byte
    whose strobe is 0 is not written. response: in: valid, 1 bit, for one tick, in a tick after the
    request's, exactly one for each request; with it error, 1 bit, and data, 32 bits, of a read;
    all three are 0 at other times.

    The requester takes a response whenever it comes, and requests nothing before it has come.
    """
    request = data.StructLayout(
        {"address": address_bits, "write": 1, "data": WORD_BITS, "strobes": WORD_BYTES}
    )
    response = {"valid": Out(1), "error": Out(1), "data": Out(WORD_BITS)}
    return wiring.Signature(
        {"request": Out(stream.Signature(request)), "response": In(wiring.Signature(response))}
    )
