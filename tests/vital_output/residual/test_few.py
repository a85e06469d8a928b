"""Errors of few bits against all errors there are, published tables and the real check."""

from __future__ import annotations

from itertools import combinations
from math import comb

import numpy as np
import pytest

from railgate.check import Check
from railgate.vital_output.residual.few import distances, few, passing
from railgate.vital_output.spec import Config
from railgate.vital_output.spec.frame import bits

CASTAGNOLI = Check(width=32, polynomial=0xF4AC_FB13)
ETHERNET = Check(width=32, polynomial=0x04C1_1DB7)

KOOPMAN = {
    # Ref: P. Koopman, CRC polynomial zoo, users.ece.cmu.edu/~koopman/crc: polynomial in his
    # notation; up to so many data bits the Hamming distance is 3, 4, 5 … or more.
    (8, 0x83): (119, 119),
    (8, 0x97): (119, 119, 3, 3),
    (8, 0x9B): (118, 118, 4, 4),
    (8, 0xA6): (247, 15, 6),
    (8, 0xE7): (247, 19, 1, 1, 1),
    (16, 0x9EB2): (135, 135, 135, 135, 6),
}


@pytest.mark.parametrize("width", [5, 8])
@pytest.mark.parametrize("polynomial", [0x05, 0x15, 0x1F])
def test_as_many_pass_as_when_all_errors_are_tried(width: int, polynomial: int) -> None:
    check = Check(width=width, polynomial=polynomial)
    counts = few(check, 7, 17)
    for length in range(width + 1, 18):
        data_bits = length - width
        words = [data << width | check.of(data, data_bits) for data in range(1 << data_bits)]
        tried = np.bincount([word.bit_count() for word in words], minlength=18)
        assert counts[1:, length].tolist() == tried[1:8].tolist()


@pytest.mark.parametrize(("width", "koopman"), KOOPMAN)
def test_the_published_hamming_distances_of_small_crcs_are_found(width: int, koopman: int) -> None:
    published = KOOPMAN[width, koopman]
    check = Check(width=width, polynomial=(koopman << 1 | 1) & (1 << width) - 1)
    found = distances(few(check, len(published) + 1, published[0] + width + 1))[width:]
    reach = [int(np.flatnonzero(found >= 3 + i)[-1]) for i in range(len(published))]
    assert tuple(reach) == published


@pytest.mark.shows("DRV-4")
def test_ethernets_polynomial_has_the_published_distances() -> None:
    long = distances(few(ETHERNET, 4, 2975 + 32))
    assert long[32 + 1 : 32 + 2975].min() == 5 == long[32 + 2974]
    assert long[32 + 2975] == 4
    found = distances(few(ETHERNET, 6, 270 + 32))
    assert found[32 + 268 : 32 + 270].tolist() == [6, 5]
    assert found[32 + 171 : 32 + 173].tolist() == [7, 6]
    assert distances(few(ETHERNET, 7, 92 + 32))[32 + 91 :].tolist() == [8, 7]


@pytest.mark.shows("DRV-4")
def test_the_default_polynomial_has_a_distance_of_8_up_to_274_data_bits_and_no_further() -> None:
    found = distances(few(CASTAGNOLI, 7, 275 + 32))
    assert set(found[33 : 32 + 275]) == {8}
    assert found[32 + 275] == 6


@pytest.mark.shows("DRV-4")
def test_at_275_data_bits_the_real_check_lets_an_error_of_6_bits_pass() -> None:
    check = Config().layout.check
    powers = [1 << k if k < 32 else CASTAGNOLI.of(1 << k - 32, k - 31) for k in range(307)]
    pairs = {powers[a] ^ powers[b]: (a, b) for a, b in combinations(range(1, 306), 2)}
    ends = powers[0] ^ powers[306]
    first = next(pair for total, pair in pairs.items() if total ^ ends in pairs)
    second = pairs[powers[first[0]] ^ powers[first[1]] ^ ends]
    error = sum(1 << k for k in (0, *first, *second, 306))
    assert error.bit_count() == 6
    data = 0x1234_5678 << 200
    wrong = (data << 32 | check.of(data, 275)) ^ error
    assert check.of(wrong >> 32, 275) == wrong & 0xFFFF_FFFF
    assert passing(CASTAGNOLI, 6, 307)[307] == 1


def _passing_the_real_check(config: Config, errors: int, length: int) -> int:
    """How many errors of so many of the code word's last `length` bits pass, each tried."""
    layout = config.layout
    data_bits = bits((*layout.implicit, *layout.frame[:-1]))
    data = 0x5641_0001_0000_0007_0000_0123_8001_7F0F
    word = data << 32 | layout.check.of(data, data_bits)
    count = tried = 0
    for places in combinations(range(length), errors):
        wrong = word
        for place in places:
            wrong ^= 1 << place
        count += layout.check.of(wrong >> 32, data_bits) == wrong & 0xFFFF_FFFF
        tried += 1
    assert tried == comb(length, errors)
    return count


@pytest.mark.shows("DRV-4")
@pytest.mark.parametrize(("errors", "length"), [(1, 160), (2, 160), (3, 96)])
def test_no_error_of_up_to_3_bits_passes_the_real_check(errors: int, length: int) -> None:
    config = Config()
    assert _passing_the_real_check(config, errors, length) == 0
    assert passing(config.layout.check, errors, length)[length] == 0


@pytest.mark.shows("DRV-4")
@pytest.mark.slow
@pytest.mark.parametrize("polynomial", [0xF4AC_FB13, 0x04C1_1DB7])
def test_nor_does_one_of_3_bits_with_board_and_time(polynomial: int) -> None:
    assert _passing_the_real_check(Config(polynomial=polynomial), 3, 160) == 0


def test_a_length_beyond_what_a_key_holds_is_refused() -> None:
    with pytest.raises(ValueError, match="longest must be between 1 and 65535, not 65536"):
        passing(CASTAGNOLI, 2, 65536)
