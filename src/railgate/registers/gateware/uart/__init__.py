"""A bridge from a serial line, for boards on a desk.

The line. Bytes of 8 bits with one start and one stop bit, no parity; it rests at 1. Bytes are in
frames by RFC 1055 (SLIP): a frame is END (0xC0), its bytes, END; a byte 0xC0 in it is sent as 0xDB
0xDC, and 0xDB as 0xDB 0xDD. So END is nothing but a frame's border: after any noise, and whatever
one side has missed, the next frame is read whole. An empty frame is none.

Frames. A frame is of words of 4 bytes, the least significant byte first; the last word is the
CRC-32 of all bytes before (ISO-HDLC: as zlib.crc32 computes it). A frame that is not whole words,
or whose CRC is wrong, is dropped and not answered.

    request   number 16 | operation 8 | count 8      answer   number 16 | status 8 | count 8
              address                                         `count` words (of a READ)
              `count` words (of a WRITE)                      CRC
              CRC

The first field stands in the least significant bits, so that the first two bytes are the number.

Operations. HELLO (0) answers with DONE and, as count, the most words that a request may have; its
count counts for nothing, nor does its address, which is sent. READ (1) reads `count` words, WRITE
(2) writes them, at least 1, one after the other from the byte address `address` on, each
whole. Status: DONE (0). BUS_ERROR (1): the bus told one of the word after the `count` first
ones; the words behind it have not been accessed. REFUSED (2): no such operation, too many words,
none, or not as many as in the frame; an address that is no multiple of 4, or words that are not
all on the bus. Nothing has been accessed, count is 0.

Retries. A host that has no good answer in time sends the same frame again: the same number and all.
If it is the request that was answered last, by its CRC, the answer is sent again as it was; nothing
is accessed, so that nothing is gated, cleared or written twice (ODO-7). A host gives each new
request another number, one up modulo 2¹⁶, and begins with a HELLO: no request after it is taken for
one that was answered before it.

Time. A host waits for the answer before it sends another request: what comes before may be dropped.
The answer begins as soon as the accesses have been made, each a few ticks unless its register waits
(registers.Gate.STROBE), and has at most 2 (4 count + 8) + 2 bytes.
"""

from railgate.registers.gateware.uart.bridge import Uart
from railgate.registers.gateware.uart.protocol import BAUD

__all__ = ["BAUD", "Uart"]
