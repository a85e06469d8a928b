"""The CPU's frames against the specification's layout and a third party's CRC."""

from __future__ import annotations

import zlib
from fractions import Fraction

import numpy as np
import pytest
from amaranth.lib.crc import Algorithm
from hypothesis import given
from hypothesis import strategies as st

from railgate.vital_output.host import encode
from railgate.vital_output.host.frames import crc
from railgate.vital_output.spec import Config, unpack
from vital_output.small import SMALL

DEFAULT = Config()
CONFIGS = (
    DEFAULT,
    SMALL,
    Config(polynomial=0x04C1_1DB7),
    Config(outputs=9, boards=(1, 0xFFFF_FFFE)),
    Config(outputs=64, release_min_s=Fraction(5, 1000)),
)
words = st.integers(0, (1 << 32) - 1)


def octets_crc(polynomial: int, data: bytes) -> int:
    (found,) = crc(polynomial, np.frombuffer(data, np.uint8)[None])
    return int(found)


@pytest.mark.shows("DRV-1")
@given(st.sampled_from(CONFIGS), st.integers(0, 1), words, words, st.data())
def test_a_frame_is_the_layouts(
    config: Config, board: int, time: int, sequence: int, data: st.DataObject
) -> None:
    outputs = st.integers(0, (1 << config.outputs) - 1)
    image, acknowledge = data.draw(outputs), data.draw(outputs)
    frame = encode(config, board, time, sequence, image, acknowledge)
    assert len(frame) == config.layout.frame_bytes
    fields = unpack(config.layout.frame, int.from_bytes(frame, "big"))
    told = {"sequence": sequence, "image": image, "acknowledge": acknowledge}
    assert fields == {**told, "crc": config.layout.crc(config.boards[board], time, told)}


@pytest.mark.shows("DRV-4")
@given(st.binary(max_size=40), words.map(lambda polynomial: polynomial | 1))
def test_the_crc_is_amaranths(data: bytes, polynomial: int) -> None:
    algorithm = Algorithm(
        crc_width=32,
        polynomial=polynomial,
        initial_crc=0xFFFF_FFFF,
        reflect_input=False,
        reflect_output=False,
        xor_output=0,
    )
    assert octets_crc(polynomial, data) == algorithm(8).compute(data)


@pytest.mark.shows("DRV-4")
@given(st.binary(max_size=40))
def test_with_ethernets_polynomial_it_is_zlibs_but_for_the_order_of_bits(data: bytes) -> None:
    def mirrored(number: int, width: int) -> int:
        return int(f"{number:0{width}b}"[::-1], 2)

    reflected = bytes(mirrored(byte, 8) for byte in data)
    assert octets_crc(0x04C1_1DB7, data) == mirrored(zlib.crc32(reflected) ^ 0xFFFF_FFFF, 32)


@pytest.mark.shows("DRV-1")
def test_a_frame_of_requirement_drv_1_byte_by_byte() -> None:
    """Its CRC, bit by bit, is over the words 56410001, 00000007, 01020304, 8001, 0002."""
    frame = encode(DEFAULT, 0, 7, 0x0102_0304, 0x8001, 2)
    assert frame[:8].hex() == "0102030480010002"
    sent = bytes.fromhex("5641000100000007") + frame[:8]
    register = 0xFFFF_FFFF
    for bit in "".join(f"{byte:08b}" for byte in sent):
        out = (register >> 31) ^ int(bit)
        register = (register << 1) % (1 << 32) ^ out * 0xF4AC_FB13
    assert int.from_bytes(frame[8:], "big") == register


@pytest.mark.shows("DRV-1")
def test_time_and_sequence_wrap() -> None:
    assert encode(DEFAULT, 0, 1 << 32, (1 << 32) + 5, 1) == encode(DEFAULT, 0, 0, 5, 1)
    assert encode(DEFAULT, 0, -1, -1, 1) == encode(DEFAULT, 0, (1 << 32) - 1, (1 << 32) - 1, 1)


def test_what_is_no_frame_is_refused() -> None:
    with pytest.raises(ValueError, match="board must be between 0 and 0x1, not 0x2"):
        encode(DEFAULT, 2, 0, 0, 0)
    with pytest.raises(ValueError, match="image must be between 0 and 0x3, not 0x4"):
        encode(SMALL, 0, 0, 0, 4)
    with pytest.raises(ValueError, match="acknowledge must be between 0 and 0xffff, not -0x1"):
        encode(DEFAULT, 0, 0, 0, 0, -1)
