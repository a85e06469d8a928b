"""A command frame in real Ethernet frames and messages: what passes their check and its own."""

from __future__ import annotations

import zlib

import numpy as np
import pytest

from railgate.check import Check
from railgate.vital_output.residual.carriage import ETHERNET, carriages
from railgate.vital_output.residual.linear import eliminate
from railgate.vital_output.spec import Config, Layout, pack, unpack
from railgate.vital_output.spec.frame import bits

DEFAULT = Config()
ALIKE = Config(polynomial=ETHERNET)
BOARD, TIME = DEFAULT.boards[0], 77
HEADER = bytes.fromhex("0180c2000001 021122334455 8100e005 88b5")
VALUES = {"sequence": 0x1234_5678, "image": 0x8001, "acknowledge": 0x0F00}


def _frame(layout: Layout) -> int:
    values = {**VALUES, "crc": layout.crc(BOARD, TIME, VALUES)}
    return pack(layout.frame, values)


def _amiss(layout: Layout, frame: int) -> int:
    """The difference of the frame's CRC from the right one: 0 where the frame passes."""
    values = unpack(layout.frame, frame)
    return layout.crc(BOARD, TIME, values) ^ values["crc"]


def _sent(layout: Layout) -> bytearray:
    """An Ethernet frame with the command frame in it."""
    covered = HEADER + _frame(layout).to_bytes(layout.frame_bytes, "big").ljust(46, b"\0")
    return bytearray(covered + zlib.crc32(covered).to_bytes(4, "little"))


def _flipped(sent: bytearray, place: int, error: int, length: int) -> bytearray:
    """With an error of so many bits, its first one at this place of the line."""
    wrong = bytearray(sent)
    for k in range(length):
        if error >> length - 1 - k & 1:
            wrong[(place + k) // 8] ^= 1 << (place + k) % 8
    return wrong


def _fcs_amiss(sent: bytearray) -> int:
    """Likewise of the frame check sequence, the bit sent first the most significant."""
    amiss = zlib.crc32(sent[:-4]) ^ int.from_bytes(sent[-4:], "little")
    return int(f"{amiss:032b}"[::-1], 2)


def _carried(layout: Layout, sent: bytearray) -> int:
    return int.from_bytes(sent[18 : 18 + layout.frame_bytes], "big")


@pytest.mark.parametrize("config", [DEFAULT, ALIKE])
def test_syndromes_are_what_each_bit_on_ethernet_adds_to_both_real_checks(config: Config) -> None:
    layout = config.layout
    sent, carriage = _sent(layout), carriages(layout)[0]
    assert (_amiss(layout, _carried(layout, sent)), _fcs_amiss(sent)) == (0, 0)
    wrong = [_flipped(sent, place, 1, 1) for place in range(8 * len(sent))]
    inside = slice(8 * 18, 8 * (18 + layout.frame_bytes))
    crc = [_amiss(layout, _carried(layout, each)) for each in wrong]
    fcs = [_fcs_amiss(each) for each in wrong]
    assert carriage.frame.tolist() == crc[inside]
    assert carriage.line.tolist() == fcs[inside]
    del fcs[inside]
    assert sorted(carriage.around.tolist()) == sorted(fcs)


@pytest.mark.shows("DRV-4")
@pytest.mark.parametrize("config", [DEFAULT, ALIKE])
def test_an_error_equal_to_the_generator_passes_the_fcs_but_as_bytes_are_sent_no_crc(
    config: Config,
) -> None:
    layout = config.layout
    sent = _sent(layout)
    wrong = [_flipped(sent, place, 1 << 32 | ETHERNET, 33) for place in range(144, 144 + 64)]
    assert {_fcs_amiss(each) for each in wrong} == {0}
    passing = sum(not _amiss(layout, _carried(layout, each)) for each in wrong)
    assert (passing, len(wrong)) == carriages(layout)[0].generators == (0, 64)


@pytest.mark.shows("DRV-4")
@pytest.mark.parametrize(("config", "passing"), [(DEFAULT, 0), (ALIKE, 64)])
def test_were_bits_sent_as_the_crc_takes_them_it_would_pass_both_of_the_same_polynomial(
    config: Config, passing: int
) -> None:
    layout = config.layout
    fcs = Check(width=32, polynomial=ETHERNET, initial=0xFFFF_FFFF, final=0xFFFF_FFFF)
    covered = int.from_bytes(_sent(layout)[:-4], "big")
    frame_ends = 8 * (46 - layout.frame_bytes)  # so many bits before the payload's last one
    right = fcs.of(covered, 8 * 64)
    count = 0
    for place in range(64):
        error = (1 << 32 | ETHERNET) << place
        assert fcs.of(covered ^ error << frame_ends, 8 * 64) == right
        count += not _amiss(layout, _frame(layout) ^ error)
    assert (count, 64) == carriages(layout)[1].generators == (passing, 64)


def test_as_bytes_are_sent_a_burst_of_29_bits_passes_the_crc_and_is_found_by_the_fcs() -> None:
    layout = DEFAULT.layout
    carriage = carriages(layout)[0]
    assert carriage.bursts == (28, 55)
    places = range(len(carriage.frame) - 28)
    sums = {place: eliminate(map(int, carriage.frame[place : place + 29]))[1] for place in places}
    place, error = next((place, found[0]) for place, found in sums.items() if found)
    burst = int(f"{error:029b}"[::-1], 2)
    wrong = _flipped(_sent(layout), 144 + place, burst, 29)
    assert _carried(layout, wrong) != _frame(layout)
    assert _amiss(layout, _carried(layout, wrong)) == 0
    assert _fcs_amiss(wrong) != 0


@pytest.mark.shows("DRV-4")
@pytest.mark.parametrize("outputs", [1, 16, 17, 64])
def test_only_the_same_polynomial_in_the_same_order_is_no_second_check(outputs: int) -> None:
    ranks = {
        polynomial: [
            c.rank for c in carriages(Config(outputs=outputs, polynomial=polynomial).layout)
        ]
        for polynomial in (DEFAULT.polynomial, ETHERNET)
    }
    assert ranks[DEFAULT.polynomial][:2] == [64, 64]
    assert ranks[ETHERNET][:2] == [64, 32]


def same_polynomial(outputs: int) -> Layout:
    """A layout that no configuration has: messages are checked as their frames are."""
    layout = Config(outputs=outputs).layout
    layout._link_polynomial = layout.check.polynomial
    return layout


@pytest.mark.parametrize("outputs", [1, 8, 16, 20, 64])
def test_an_error_in_a_forwarded_frame_has_two_checks_to_pass(outputs: int) -> None:
    carriage = carriages(Config(outputs=outputs).layout)[2]
    assert carriage.rank == 63  # both polynomials tell odd errors, and so agree in one bit
    assert carriage.generators[0] == 0


@pytest.mark.parametrize("outputs", [8, 16, 64])
def test_with_the_frames_polynomial_the_link_would_find_the_same_errors(outputs: int) -> None:
    layout = same_polynomial(outputs)
    carriage = carriages(layout)[2]
    assert carriage.rank == 32
    check = layout.message_check(BOARD)
    values = {f.name: 1 for f in layout.message} | {**VALUES, "image": 1, "acknowledge": 1}
    values["frame_crc"] = layout.crc(BOARD, TIME, values)
    values["crc"] = 0
    covered = pack(layout.message, values) >> 32
    right = check.of(covered, bits(layout.message) - 32)
    for place in range(carriage.generators[1]):
        wrong = covered ^ (1 << 32 | layout.check.polynomial) << place
        assert check.of(wrong, bits(layout.message) - 32) == right
        told = unpack(layout.message, wrong << 32 | right)
        assert layout.crc(BOARD, TIME, told) == told["frame_crc"]
    assert carriage.generators == (carriage.generators[1],) * 2


@pytest.mark.parametrize("outputs", [3, 16, 20])
def test_syndromes_on_the_cross_link_are_those_of_the_real_checks(outputs: int) -> None:
    layout = Config(outputs=outputs).layout
    carriage = carriages(layout)[2]
    check, covered_bits = layout.message_check(BOARD), bits(layout.message) - 32
    values = dict.fromkeys((f.name for f in layout.message), 1)
    values["frame_crc"] = layout.crc(BOARD, TIME, values)
    message = pack(layout.message, values)
    right = check.of(message >> 32, covered_bits)
    before = covered_bits - len(carriage.frame)
    for place, (frame, line) in enumerate(zip(carriage.frame, carriage.line, strict=True)):
        wrong = message ^ 1 << bits(layout.message) - 1 - before - place
        told = unpack(layout.message, wrong)
        assert layout.crc(BOARD, TIME, told) ^ told["frame_crc"] == frame
        assert check.of(wrong >> 32, covered_bits) ^ right == line
    assert len(carriage.around) == before + 32
    assert np.unique(carriage.around).size == before + 32
