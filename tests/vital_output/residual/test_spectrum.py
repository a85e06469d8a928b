"""Weight distributions against all words there are, and against errors counted another way."""

from __future__ import annotations

import numpy as np
import pytest

from railgate.check import Check
from railgate.vital_output.residual.few import few
from railgate.vital_output.residual.linear import Syndromes, syndromes
from railgate.vital_output.residual.spectrum import probability, spectrum
from railgate.vital_output.spec import Config


def _tried(code: Syndromes) -> np.ndarray:
    """The sum of syndromes of every error there is."""
    sums = np.zeros(1, np.uint64)
    for syndrome in code:
        sums = np.concatenate([sums, sums ^ syndrome])
    return sums


@pytest.mark.parametrize("length", [9, 12, 16, 17, 20])
@pytest.mark.parametrize("polynomial", [0x07, 0x2F, 0x9B, 0x39])
def test_it_is_that_of_all_errors_tried(polynomial: int, length: int) -> None:
    code = syndromes(Check(width=8, polynomial=polynomial), length)
    passing = np.flatnonzero(_tried(code) == 0)
    weights = np.bincount([int(error).bit_count() for error in passing], minlength=length + 1)
    assert spectrum(code) == tuple(weights)


def test_dependent_checks_are_counted_once() -> None:
    code = syndromes(Check(width=8, polynomial=0x07), 20)
    assert spectrum(code << np.uint64(32) | code) == spectrum(code)


@pytest.mark.parametrize("length", [40, 64, 65, 130])
def test_a_long_codes_is_that_of_errors_counted_by_few(length: int) -> None:
    check = Check(width=16, polynomial=0x1021)
    whole = spectrum(syndromes(check, length))
    assert sum(whole) == 1 << length - 16
    assert whole[1:6] == tuple(few(check, 5, length)[1:, length])


@pytest.mark.parametrize("rate", [1e-3, 0.1, 0.5])
def test_the_probability_is_that_of_all_errors_that_pass(rate: float) -> None:
    code = syndromes(Check(width=8, polynomial=0x2F), 16)
    weights = [int(error).bit_count() for error in np.flatnonzero(_tried(code) == 0)[1:]]
    expected = sum(rate**w * (1 - rate) ** (16 - w) for w in weights)
    assert probability(spectrum(code), rate) == pytest.approx(expected, rel=1e-12, abs=0)


def test_no_sum_of_syndromes_is_likelier_than_0() -> None:
    # What the bound of errors anywhere in an Ethernet frame rests on.
    code = syndromes(Check(width=6, polynomial=0x03), 14)
    weights = np.array([error.bit_count() for error in range(1 << 14)])
    for rate in (1e-3, 0.05, 0.3, 0.5):
        likely = np.bincount(_tried(code), rate**weights * (1 - rate) ** (14 - weights))
        assert likely.max() == pytest.approx(likely[0], rel=1e-12, abs=0)
        assert likely[0] == pytest.approx((1 - rate) ** 14 + probability(spectrum(code), rate))


def test_what_is_too_much_to_be_counted_is_refused() -> None:
    code = np.uint64(1) << np.arange(34, dtype=np.uint64)
    with pytest.raises(ValueError, match=r"must have at most 2\^33 words, not 2\^34"):
        spectrum(np.tile(code, 3))


def test_progress_rises_to_the_end() -> None:
    told: list[float] = []
    spectrum(syndromes(Check(width=26, polynomial=0x123_4567), 60), told.append)
    assert told == sorted(told)
    assert told[-1] == 1
    assert len(told) > 3


@pytest.mark.slow
@pytest.mark.parametrize(
    ("polynomial", "outputs", "at_distance"),
    [
        (0xF4AC_FB13, 16, (8, 131)),
        (0x04C1_1DB7, 16, (8, 7)),
        (0xF4AC_FB13, 64, (8, 19428)),
        (0x04C1_1DB7, 64, (7, 322)),
    ],
)
def test_the_frames_agrees_with_errors_counted_by_few(
    polynomial: int, outputs: int, at_distance: tuple[int, int]
) -> None:
    layout = Config(polynomial=polynomial, outputs=outputs).layout
    length = 8 * layout.frame_bytes
    whole = spectrum(syndromes(layout.check, length))
    assert sum(whole) == 1 << length - 32
    most = 8 if outputs == 16 else 7
    assert whole[1 : most + 1] == tuple(few(layout.check, most, length)[1:, length])
    assert next((w, a) for w, a in enumerate(whole) if w and a) == at_distance
    if polynomial == 0xF4AC_FB13:  # it has the factor x + 1
        assert not any(whole[1::2])
