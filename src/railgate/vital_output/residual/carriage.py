"""A command frame on a line that has a check of its own around it: what passes both.

On Ethernet it lies behind addresses, an 802.1Q tag and a type, is padded to the least payload, and
the frame check sequence covers it all. Ethernet sends each byte with the least significant bit
first, and its check takes the bits in this order; the frame's CRC takes the most significant first.
So the same polynomial is not the same check of the same bits, unless something sends the most
significant bit first: both orders are looked at. The cross-link's message does send it first.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from railgate.check import Check
from railgate.vital_output.residual.linear import Syndromes, burst, eliminate, syndromes
from railgate.vital_output.spec.frame import CRC_BITS, Layout, bits

__all__ = ["ETHERNET", "Carriage", "carriages"]

ETHERNET = 0x04C1_1DB7
"""The frame check sequence's polynomial."""
HEADER_BYTES = 6 + 6 + 4 + 2
PAYLOAD_BYTES = 46
FORWARDED = ("sequence", "image", "acknowledge", "frame_crc")


@dataclass(frozen=True, eq=False)
class Carriage:
    """The bits of a command frame, in the order in which they are sent, the first one first.

    frame: their syndromes of the frame's CRC. line: those of the line's check. around: the line's
    check of all its other bits. polynomial: the line's.
    """

    name: str
    frame: Syndromes
    line: Syndromes
    around: Syndromes
    polynomial: int

    @cached_property
    def both(self) -> Syndromes:
        """Of the two checks together."""
        return self.frame << np.uint64(CRC_BITS) | self.line

    @property
    def rank(self) -> int:
        """Bits of the two checks that are independent of one another."""
        return len(eliminate(map(int, self.both))[0])

    @property
    def bursts(self) -> tuple[int, int]:
        """Up to these lengths all bursts are detected: by the frame's CRC, by one of the two."""
        return burst(self.frame), burst(self.both)

    @property
    def generators(self) -> tuple[int, int]:
        """At how many places an error equal to the line's generator passes both; of how many."""
        terms = self.polynomial | 1 << CRC_BITS
        error = np.array([CRC_BITS - k for k in range(CRC_BITS + 1) if terms >> k & 1])
        places = range(len(self.both) - CRC_BITS)
        sums = [np.bitwise_xor.reduce(self.both[place + error]) for place in places]
        return sum(int(not total) for total in sums), len(places)


def carriages(layout: Layout) -> tuple[Carriage, Carriage, Carriage]:
    """On Ethernet, on Ethernet with bytes the most significant bit first, and on the cross-link."""
    n = bits(layout.frame)
    frame = syndromes(layout.check, n)
    payload = max(PAYLOAD_BYTES, layout.frame_bytes)
    whole = 8 * (HEADER_BYTES + payload) + CRC_BITS
    fcs = syndromes(Check(width=CRC_BITS, polynomial=ETHERNET), whole)
    line, around = np.split(np.roll(fcs, -8 * HEADER_BYTES), [n])
    reversed_bytes = frame.reshape(-1, 8)[:, ::-1].ravel()
    return (
        Carriage("Ethernet", reversed_bytes, line, around, ETHERNET),
        Carriage("Ethernet, bits reversed", frame, line, around, ETHERNET),
        _forwarded(layout, frame),
    )


def _forwarded(layout: Layout, frame: Syndromes) -> Carriage:
    """Of image and acknowledge a message has no padding."""
    check = layout.message_check(0)  # which board begins it does not matter to an error
    message = syndromes(check, bits(layout.message))
    names = np.repeat([f.name for f in layout.message], [f.width for f in layout.message])
    inside = np.isin(names, FORWARDED)
    widths = {f.name.removeprefix("frame_"): f.width for f in layout.message if f.name in FORWARDED}
    sent = [[False] * (f.width - widths[f.name]) + [True] * widths[f.name] for f in layout.frame]
    return Carriage(
        "cross-link",
        frame[np.concatenate(sent)],
        message[inside],
        message[~inside],
        check.polynomial,
    )
