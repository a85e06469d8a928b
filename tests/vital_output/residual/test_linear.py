"""Syndromes, ranks and bursts against the check itself and against all errors there are."""

from __future__ import annotations

from functools import reduce
from operator import xor

import pytest
from hypothesis import given
from hypothesis import strategies as st

from railgate.check import Check
from railgate.vital_output.residual.linear import burst, eliminate, syndromes
from railgate.vital_output.spec import Config
from railgate.vital_output.spec.frame import bits

POLYNOMIALS = [0xF4AC_FB13, 0x04C1_1DB7]


@pytest.mark.parametrize("polynomial", POLYNOMIALS)
def test_a_syndrome_is_what_an_error_of_its_bit_adds_to_the_real_check(polynomial: int) -> None:
    layout = Config(polynomial=polynomial).layout
    data_bits = bits((*layout.implicit, *layout.frame[:-1]))
    data = 0x5641_0001_0000_0007_0000_0123_8001_7F0F
    crc = layout.check.of(data, data_bits)
    for i, syndrome in enumerate(syndromes(layout.check, data_bits + 32)):
        wrong = (data << 32 | crc) ^ 1 << data_bits + 31 - i
        assert layout.check.of(wrong >> 32, data_bits) ^ wrong & 0xFFFF_FFFF == syndrome


@given(st.lists(st.integers(0, 255), max_size=16))
def test_elimination_finds_a_basis_and_all_independent_sums_that_are_0(vectors: list[int]) -> None:
    basis, sums = eliminate(vectors)
    span = {0}
    for vector in vectors:
        span |= {vector ^ other for other in span}
    assert len(span) == 1 << len(basis)
    assert len(basis) + len(sums) == len(vectors)
    for mask in sums:
        assert reduce(xor, (v for i, v in enumerate(vectors) if mask >> i & 1)) == 0
    assert len(eliminate(sums)[0]) == len(sums)


@pytest.mark.parametrize("polynomial", [0x07, 0x2F, 0x9B])
@pytest.mark.parametrize("order", [1, -1])
def test_no_burst_of_that_length_passes_and_one_that_is_longer_does(
    polynomial: int, order: int
) -> None:
    # Half of the bytes the other way round, so that 8 is not just the width.
    code = syndromes(Check(width=8, polynomial=polynomial), 24)
    code[8:16] = code[8:16][::order]
    length = burst(code)
    columns = code.tolist()
    passing = [
        last - first
        for first in range(24)
        for last in range(first + 1, min(first + length + 1, 24))
        for inside in range(1 << last - first - 1)
        if not reduce(xor, (columns[first + 1 + k] for k in range(11) if inside >> k & 1), 0)
        ^ columns[first]
        ^ columns[last]
    ]
    assert set(passing) == {length}
    assert (length == 8) == (order == 1)


@pytest.mark.shows("DRV-4")
@pytest.mark.parametrize("outputs", [1, 16, 64])
@pytest.mark.parametrize("polynomial", POLYNOMIALS)
def test_every_burst_of_32_bits_is_detected_wherever_it_lies(polynomial: int, outputs: int) -> None:
    layout = Config(polynomial=polynomial, outputs=outputs).layout
    code = syndromes(layout.check, bits((*layout.implicit, *layout.frame)))
    windows = [[int(s) for s in code[i : i + 32]] for i in range(len(code) - 31)]
    assert {len(eliminate(window)[0]) for window in windows} == {32}
    assert burst(code) == 32
