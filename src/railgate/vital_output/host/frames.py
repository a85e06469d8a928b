"""The command frame as a CPU makes it, written apart from the specification's Layout and Check.

Ref: source 004, paragraphs 14 to 18; DRV-1, DRV-2, DRV-4.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from railgate.vital_output.spec import Config

__all__ = ["crc", "encode", "encoded"]

WORD = (1 << 32) - 1

Octets = NDArray[np.uint8]


def encode(
    config: Config, board: int, time: int, sequence: int, image: int, acknowledge: int = 0
) -> bytes:
    """A frame for FPGA `board` + 1 in the system cycle `time`, as it is sent.

    board: 0 or 1, which of config.boards. time, sequence: modulo 2³². image, acknowledge: bit i is
    output i's. Board and time are in the CRC alone. Raises ValueError.
    """
    (frame,) = encoded(config, [board], [time & WORD], [sequence & WORD], [image], [acknowledge])
    return bytes(frame)


def encoded(
    config: Config,
    boards: Sequence[int],
    times: Sequence[int],
    sequences: Sequence[int],
    images: Sequence[int],
    acknowledges: Sequence[int],
) -> Octets:
    """Many frames at once, shape (n, frame_bytes): as `encode`, with all below 2³²."""
    _require("board", boards, 1)
    for name, told in (("image", images), ("acknowledge", acknowledges)):
        _require(name, told, (1 << config.outputs) - 1)
    size = -(-config.outputs // 8)
    board_ids = [config.boards[board] for board in boards]
    sent = [_octets(sequences, 4), _octets(images, size), _octets(acknowledges, size)]
    covered = np.concatenate([_octets(board_ids, 4), _octets(times, 4), *sent], axis=1)
    return np.concatenate([*sent, _octets(crc(config.polynomial, covered), 4)], axis=1)


def _require(name: str, numbers: Sequence[int], most: int) -> None:
    """Raises ValueError unless each is between 0 and `most`."""
    for number in set(numbers):
        if not 0 <= number <= most:
            raise ValueError(f"{name} must be between 0 and {most:#x}, not {number:#x}")


def _octets(numbers: ArrayLike, size: int) -> Octets:
    """The low bytes of each number, the most significant one first: shape (n, size)."""
    big = np.asarray(numbers, np.uint64).astype(">u8")
    return big.view(np.uint8).reshape(-1, 8)[:, 8 - size :]


def crc(polynomial: int, data: Octets) -> NDArray[np.uint32]:
    """The CRC of 32 bits over each row of bytes: the register starts as all ones, the most
    significant bit goes first, nothing is added at the end. data: (n, bytes); returns (n,)."""
    table = _table(polynomial)
    register = np.full(data.shape[0], WORD, np.uint32)
    for column in data.T:
        register = register << np.uint32(8) ^ table[register >> np.uint32(24) ^ column]
    return register


@cache
def _table(polynomial: int) -> NDArray[np.uint32]:
    """What eight steps make of each byte at the register's top."""
    register = np.arange(256, dtype=np.uint32) << np.uint32(24)
    for _ in range(8):
        register = register << np.uint32(1) ^ (register >> np.uint32(31)) * np.uint32(polynomial)
    return register
