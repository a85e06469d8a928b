"""Words in parts of 64 bits against plain numbers."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from railgate.position_link.host.words import (
    check_fields,
    extract,
    insert,
    pack,
    parted,
    sound,
    unpack,
)
from railgate.position_link.spec import EVEN, ODD, Check, Config


def drawn(bits: int) -> st.SearchStrategy[int]:
    """Numbers of so many bits, the high ones as often 1 as the low ones."""
    size = -(-bits // 8)
    return st.binary(min_size=size, max_size=size).map(
        lambda raw: int.from_bytes(raw, "big") >> 8 * size - bits
    )


@st.composite
def words(draw: st.DrawFn) -> tuple[int, list[int]]:
    bits = draw(st.sampled_from([8, 33, 63, 64, 65, 128, 200, 511, 512]))
    return bits, draw(st.lists(drawn(bits), max_size=5))


@st.composite
def checks(draw: st.DrawFn) -> Check:
    width = draw(st.integers(1, 64))
    top = (1 << width) - 1
    return Check(
        width=width,
        polynomial=draw(st.integers(1, top)),
        initial=draw(st.integers(0, top)),
        final=draw(st.integers(0, top)),
    )


@given(words())
def test_words_come_back_as_they_were(given_words: tuple[int, list[int]]) -> None:
    bits, numbers = given_words
    packed = pack(numbers, bits)
    assert packed.dtype == np.uint64
    assert packed.shape == ((len(numbers),) if bits <= 64 else (len(numbers), -(-bits // 64)))
    assert unpack(packed) == numbers
    assert unpack(parted(packed, bits)) == numbers


def test_the_first_part_is_the_least_significant_one() -> None:
    assert pack([(3 << 64) + 5], 66).tolist() == [[5, 3]]


@given(words(), st.data())
def test_bits_are_taken_from_and_put_where_they_are(
    given_words: tuple[int, list[int]], data: st.DataObject
) -> None:
    bits, numbers = given_words
    lsb = data.draw(st.integers(0, bits - 1))
    width = data.draw(st.integers(1, min(64, bits - lsb)))
    wanted = [number >> lsb & (1 << width) - 1 for number in numbers]
    rows = parted(pack(numbers, bits), bits)
    found = extract(rows, lsb, width)
    assert found.tolist() == wanted
    empty = np.zeros_like(rows)
    insert(empty, lsb, width, found)
    assert unpack(empty) == [one << lsb for one in wanted]


@given(words(), checks() | st.sampled_from([EVEN, ODD]))
def test_the_check_of_many_words_is_that_of_each(
    given_words: tuple[int, list[int]], check: Check
) -> None:
    bits, numbers = given_words
    if check.width >= bits:
        return
    found = check_fields(parted(pack(numbers, bits), bits), bits, check)
    data_bits = bits - check.width
    assert found.tolist() == [check.of(number >> check.width, data_bits) for number in numbers]


@pytest.mark.parametrize("bits", [64, 512])
def test_the_fault_word_zero_and_a_false_check_are_no_good_words(bits: int) -> None:
    data = 12 << bits - 8
    numbers = [(1 << bits) - 1, 0, data, data | 1 << bits // 2, (1 << bits) - 2]
    rows = parted(pack(numbers, bits), bits)

    def good(config: Config) -> list[bool]:
        return sound(rows, config).tolist()

    assert good(Config(word_bits=bits)) == [False, True, True, True, True]
    assert good(Config(word_bits=bits, zero_is_fault=True)) == [False, False, True, True, True]
    assert good(Config(word_bits=bits, fault_word=data)) == [True, True, False, True, True]
    even = Config(word_bits=bits, check=EVEN)
    assert good(even) == [False, True, True, False, False]


def test_what_is_no_word_is_refused() -> None:
    with pytest.raises(ValueError, match="a word must have 12 bits, not be 0x1000"):
        pack([1, 0x1000], 12)
    with pytest.raises(ValueError, match="a word must have 12 bits, not be -0x1"):
        pack([-1], 12)
    with pytest.raises(ValueError, match="a word must have at most 12 bits, not more"):
        parted(np.array([0x1000], np.uint64), 12)
    with pytest.raises(ValueError, match=r"must be uint64 in 1 columns, not int64 of shape \(1,\)"):
        parted(np.array([1]), 12)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"uint64 in 2 columns, not uint64 of shape \(3,\)"):
        parted(np.zeros(3, np.uint64), 65)
