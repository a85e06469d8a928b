"""The configuration: the source's figures, the divider, and what it refuses."""

from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from railgate.position_link.spec import CRC16, EVEN, ODD, Cause, Check, Config

CONFIG = Config()


@pytest.mark.shows("LNK-1", "LNK-2", "LNK-3")
def test_the_source_s_figures_are_the_defaults() -> None:
    """Source 001, paragraphs 13 to 15: 40 MHz, 512 kHz, 20 ms, 10 CLK, 30 CLK, three cycles."""
    assert (CONFIG.bits, CONFIG.ticks) == (8, 625)
    assert (CONFIG.cycle_bits, CONFIG.cycle_ticks) == (10_240, 800_000)
    assert (CONFIG.request_bits, CONFIG.window_bits) == (10, 30)
    assert CONFIG.tolerated_cycles * CONFIG.cycle_s == Fraction(60, 1000)
    assert CONFIG.invalid_word == 2**64 - 1


@pytest.mark.shows("LNK-1")
@pytest.mark.parametrize(
    ("clock_mhz", "ratio"),
    [(40, "8/625"), (48, "4/375"), (50, "32/3125"), (100, "16/3125"), (125, "64/15625")],
)
def test_every_clock_has_an_exact_divider(clock_mhz: int, ratio: str) -> None:
    config = Config(clock_hz=clock_mhz * 10**6)
    assert Fraction(config.bits, config.ticks) == Fraction(ratio)
    assert config.rise(config.cycle_bits) == config.cycle_ticks


@pytest.mark.shows("LNK-1")
@given(st.sampled_from([40, 48, 50, 100, 125]), st.integers(0, 10_240))
def test_an_edge_is_less_than_a_tick_after_its_instant(clock_mhz: int, n: int) -> None:
    config = Config(clock_hz=clock_mhz * 10**6)
    period = config.clock_hz / config.bit_rate_hz
    assert 0 <= config.rise(n) - n * period < 1
    assert 0 <= config.fall(n) - (n + Fraction(1, 2)) * period < 1


@pytest.mark.shows("LNK-6")
@pytest.mark.parametrize("changes", [{}, {"word_bits": 512}, {"bare": True}, {"word_bits": 8}])
def test_the_frame_begins_with_the_first_clk_after_the_delivery(changes: dict[str, Any]) -> None:
    config = Config(**changes)
    assert config.rise(config.radio_first - 1) <= config.delivery_ticks
    assert config.delivery_ticks < config.rise(config.radio_first)


@pytest.mark.shows("LNK-6")
def test_the_decision_is_behind_the_longest_answer() -> None:
    """UEF rises in the last tick of the window and is one CLK too long."""
    latest = CONFIG.rise(CONFIG.window_bits) - 1
    samples = [CONFIG.fall(n) for n in range(200) if CONFIG.fall(n) >= latest]
    too_long = samples[CONFIG.word_bits] + CONFIG.guard_ticks
    assert too_long + CONFIG.input_delay_ticks < CONFIG.decision_ticks


def test_fields_have_names_of_their_own_and_one_count_for_each_cause() -> None:
    names = [field.name for field in CONFIG.fields]
    assert len(set(names)) == len(names)
    assert {f"{cause.name.lower()}_cycles" for cause in Cause} <= set(names)
    assert sum(field.width for field in CONFIG.frame_fields) == CONFIG.frame_bits == 96


@pytest.mark.shows("LNK-7")
def test_checks_are_those_of_the_books() -> None:
    """Check values of the catalogue of parametrised CRC algorithms: CRC of "123456789"."""
    digits = int.from_bytes(b"123456789", "big")
    assert CRC16.of(digits, 72) == 0x29B1
    assert Check(width=8, polynomial=0x07).of(digits, 72) == 0xF4
    assert Check(width=32, polynomial=0xF4ACFB13).width == 32
    assert (
        Check(width=32, polynomial=0x04C11DB7, initial=2**32 - 1, final=2**32 - 1).of(digits, 72)
        == 0xFC891918
    )
    assert (EVEN.of(0b1011, 4), ODD.of(0b1011, 4)) == (1, 0)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        (
            {"bit_rate_hz": Fraction(512_001)},
            "bit_rate_hz must give a whole number in 0.02 s, the nearest are 512000 and 512050, "
            "not 512001",
        ),
        ({"clock_hz": 40_000_010}, "the nearest are 40000000 and 40000050, not 40000010"),
        ({"bit_rate_hz": Fraction(6_000_000)}, "between 1 and 5000000, not 6000000"),
        ({"word_bits": 7}, "word_bits must be between 8 and 512, not 7"),
        ({"word_bits": 513}, "word_bits must be between 8 and 512, not 513"),
        ({"earliest_clk": 31}, "earliest_clk must be between 1 and 30, not 31"),
        ({"timeout_bits": 0}, "timeout_bits must be between 1 and 1000, not 0"),
        ({"tolerated_cycles": 0}, "tolerated_cycles must be between 1 and 255, not 0"),
        ({"recovery_cycles": 0}, "recovery_cycles must be between 1 and 255, not 0"),
        ({"filter_ticks": 39}, "below half a bit, at most 38, not 39"),
        ({"guard_ticks": 20}, "below a quarter of a bit, at most 19, not 20"),
        ({"fault_word": 1 << 64}, "fault_word must have 64 bits, not be 0x1" + 16 * "0"),
        ({"word_bits": 8, "check": CRC16}, "narrower than the word's 8 bits, not 16"),
        (
            {"cycle_s": Fraction(1, 4000), "request_bits": 128},
            "request_bits must be below the cycle's 128 CLK, not 128",
        ),
        ({"cycle_s": Fraction(1, 4000)}, "hold answer and frame, at least 192 bits, not 128"),
    ],
)
def test_what_cannot_be_is_refused(changes: dict[str, Any], says: str) -> None:
    with pytest.raises(ValueError, match=r"^[^\n]*$") as error:
        Config(**changes)
    assert says in str(error.value)


@pytest.mark.parametrize(
    "changes", [{"width": 0}, {"width": 65}, {"polynomial": 0}, {"initial": 256}, {"final": -1}]
)
def test_a_check_that_cannot_be_is_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=f"{next(iter(changes))} must be between"):
        Check(**{"width": 8, "polynomial": 7} | changes)
