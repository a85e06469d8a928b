"""Messages on the cross-link of a pair, falsified on their way."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from railgate.vital_output.plant.edges import Edges
from railgate.vital_output.plant.scenario import Scenario
from railgate.vital_output.spec import Config, pack
from railgate.waves import Waveform

__all__ = ["Line", "altered"]

FIRST_START = 8
"""The tick of the sender in which message 0 begins."""


def altered(config: Config, changes: Mapping[str, int]) -> int:
    """The bits of a message from its start bit on, 1 where fields are inverted by these values;
    so are those of the message's CRC, unless it is told, so that it stays right."""
    layout = config.layout
    inverted = {field.name: 0 for field in layout.message} | dict(changes)
    if "crc" not in changes:
        body, count = pack(layout.message[:-1], inverted), layout.message_bits - 33
        check = layout.message_check(0)
        inverted["crc"] = check.of(body, count) ^ check.of(0, count)
    return pack(layout.message, inverted)


@dataclass(frozen=True)
class Line:
    """From FPGA `fpga` to the other one, without a delay."""

    scenario: Scenario
    config: Config
    fpga: int

    @cached_property
    def edges(self) -> Edges:
        return Edges(self.scenario.clocks(self.config)[self.fpga - 1])

    def start(self, message: int) -> int:
        """The sender's tick in which this one begins."""
        return FIRST_START + message * self.config.link_period_ticks

    def first_after(self, time: int) -> int:
        """The first message that tells of registers as they are in this femtosecond."""
        least = int(self.edges.during(time)) + 2 - FIRST_START
        return -(-least // self.config.link_period_ticks)

    def disturbed(self, patterns: Mapping[int, int]) -> Waveform:
        """1 where a bit of a message is, by the message the bits from its start bit on."""
        bits, bit_ticks = self.config.layout.message_bits, self.config.bit_ticks
        ticks, values = [0], [0]
        for message, pattern in sorted(patterns.items()):
            begin = self.start(message)
            ticks += range(begin, begin + (bits + 1) * bit_ticks, bit_ticks)
            values += [*(pattern >> bit & 1 for bit in reversed(range(bits))), 0]
        return Waveform.of(self.edges.begin(ticks), values)
