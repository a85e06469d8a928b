"""Messages of the cross-link, as they are on the line."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from railgate.vital_output.spec import Config, pack
from railgate.vital_output.spec.frame import CRC_BITS, bits

__all__ = ["levelled", "line", "message", "verdict_ticks"]


def message(config: Config, board: int, **fields: int) -> list[int]:
    """The bits, start bit first, of a message that this board sends; fields not told are 0."""
    there = {field.name: 0 for field in config.layout.message}
    body = config.layout.message[:-1]
    packed = pack(body, there | {"digest": config.digest} | fields)
    crc = config.layout.message_check(config.boards[board]).of(packed, bits(body))
    count = config.layout.message_bits
    packed = packed << CRC_BITS | crc
    return [packed >> place & 1 for place in reversed(range(count))]


def line(config: Config, messages: Mapping[int, Iterable[int]]) -> dict[int, int]:
    """The line's levels, by the ticks in which they begin, from the messages' bits by the ticks in
    which they begin; it is 1 where none is."""
    levels = {0: 1}
    for start, sent in sorted(messages.items()):
        for place, level in enumerate(sent):
            levels[start + place * config.bit_ticks] = level
        levels[start + config.message_ticks] = 1
    return levels


def levelled(levels: Mapping[int, int], end: int) -> list[int]:
    """The level in each tick before `end`."""
    level, each = 1, []
    for tick in range(end):
        level = levels.get(tick, level)
        each.append(level)
    return each


def verdict_ticks(config: Config) -> int:
    """From a message's beginning at the pin to its verdict."""
    sample = (config.layout.message_bits - 1) * config.bit_ticks + config.bit_ticks // 2
    return 3 + config.link_filter_ticks + sample + 1
