"""A scenario's words, its clock arithmetic, its size, and what it refuses."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from position_link.plant.stimuli import CONFIGS, SMALL
from railgate.position_link.plant import LAYOUT, Plan, Scenario, controls, drive, fault
from railgate.position_link.plant.clk import Clk
from railgate.position_link.plant.words import checks, from_bits, to_bits
from railgate.position_link.spec import CRC16, EVEN, ODD, Check, Config

DEFAULT = Config()


@pytest.mark.parametrize("config", [DEFAULT, *CONFIGS])
def test_clk_is_that_of_the_specification(config: Config) -> None:
    clk = Clk(config)
    periods = np.array([0, 1, 2, 7, config.cycle_bits - 1])
    for c in (0, 3):
        begin = 1 + c * config.cycle_ticks
        rises = [begin + config.rise(int(n)) for n in periods]
        falls = [begin + config.fall(int(n)) for n in periods]
        assert clk.rise(c * config.cycle_bits + periods).tolist() == rises
        assert clk.fall(c * config.cycle_bits + periods).tolist() == falls


@pytest.mark.parametrize("config", CONFIGS)
def test_falls_are_counted_to_the_tick(config: Config) -> None:
    ticks = np.arange(1, 2 * config.cycle_ticks)
    falls = Clk(config).fall(np.arange(2 * config.cycle_bits))
    assert (Clk(config).falls_before(ticks) == np.searchsorted(falls, ticks)).all()


@given(st.lists(st.integers(0, (1 << 70) - 1), min_size=1, max_size=5), st.integers(1, 70))
def test_bits_and_words_are_the_same_numbers(numbers: list[int], width: int) -> None:
    cut = [number & (1 << width) - 1 for number in numbers]
    bits = np.array([[n >> i & 1 for i in reversed(range(width))] for n in cut], np.uint8)
    words = from_bits(bits)
    assert [sum(int(p) << 64 * i for i, p in enumerate(row)) for row in words] == cut
    assert (to_bits(words, width) == bits).all()


WIDEST = Check(width=64, polynomial=0x42F0E1EBA9EA3693, initial=(1 << 64) - 1, final=1)


@pytest.mark.parametrize("check", [EVEN, ODD, CRC16, WIDEST])
@given(numbers=st.lists(st.integers(0, (1 << 90) - 1), min_size=1, max_size=4))
def test_checks_are_those_of_the_specification(check: Check, numbers: list[int]) -> None:
    bits = np.array([[n >> i & 1 for i in reversed(range(90))] for n in numbers], np.uint8)
    assert checks(check, bits)[:, 0].tolist() == [check.of(n, 90) for n in numbers]


def fields(told: Plan) -> dict[str, np.ndarray]:
    values, packed = {}, told.words[:, 0]
    for field in reversed(LAYOUT):
        values[field.name] = (packed & np.uint64((1 << field.width) - 1)).astype(np.int64)
        packed = packed >> np.uint64(field.width)
    return values


def test_a_train_runs_along_smoothly_at_about_its_speed() -> None:
    told = fields(Scenario(speed_kmh=360, seed=3).plan(DEFAULT, 5000))
    steps = np.diff(told["position"])
    assert (np.abs(steps - 2000) <= 101).all()
    assert np.abs(np.diff(steps)).max() <= 2
    assert (np.abs(told["speed"] - 1000) <= 50).all()
    assert (np.abs(steps / 2 - told["speed"][1:]) <= 2).all()
    assert told["sequence"].tolist() == [c % 4096 for c in range(5000)]


def test_a_train_is_that_of_its_seed() -> None:
    first, again, other = (Scenario(seed=seed).plan(DEFAULT, 9).words for seed in (0, 0, 1))
    assert (first == again).all()
    assert (first != other).any()


@pytest.mark.parametrize("fault_word", [None, 0, 1, 0x80])
@pytest.mark.parametrize("check", [None, EVEN, ODD, Check(width=3, polynomial=3, final=5)])
def test_no_word_of_a_train_is_a_fault(fault_word: int | None, check: Check | None) -> None:
    config = Config(**SMALL, fault_word=fault_word, check=check)
    words = [int(word) for word in Scenario().plan(config, 600).words[:, 0]]
    assert not {0, config.invalid_word} & set(words)
    assert len(set(words)) > 20
    if check:
        low = (1 << check.width) - 1
        assert all(word & low == check.of(word >> check.width, 8 - check.width) for word in words)


def test_a_wide_word_has_the_train_at_its_end_before_the_check() -> None:
    config = Config(word_bits=200, check=CRC16)
    plain = Scenario().plan(DEFAULT, 3).words[:, 0]
    for row, payload in zip(Scenario().plan(config, 3).words, plain, strict=True):
        number = sum(int(part) << 64 * i for i, part in enumerate(row))
        assert number == int(payload) << 16 | CRC16.of(int(payload), 184)


def test_own_words_are_sent_in_turn_and_left_as_they_are() -> None:
    own = np.array([3, 1, 2], np.uint64)
    told = Scenario(words=own, faults=(fault("zero-word@0s"),)).plan(DEFAULT, 5)
    assert told.words[:, 0].tolist() == [0, 1, 2, 3, 1]
    assert own.tolist() == [3, 1, 2]


def test_an_hour_is_small() -> None:
    pins = drive(Scenario(), DEFAULT, 180_000)
    assert pins.end == 1 + 3600 * 40_000_000
    assert len(pins["uef"].rising()) == 180_000
    assert sum(w.ticks.nbytes + w.values.nbytes for w in pins.signals.values()) < 80e6


def test_wide_words_are_told_in_parts() -> None:
    told = controls(Scenario(), CONFIGS[2], 2)
    assert (told["system.word.0"].width, told["system.word.1"].width) == (64, 6)


@pytest.mark.parametrize(
    ("fields", "cycles", "message"),
    [
        ({}, 0, "cycles must be between 1 and 2000000, not 0"),
        ({"speed_kmh": -1}, 1, "speed_kmh must be between 0 and 1000, not -1"),
        ({"speed_kmh": float("nan")}, 1, "speed_kmh must be between 0 and 1000, not nan"),
        ({"seed": -1}, 1, "seed must be between 0 and .*, not -1"),
        ({"delay_ticks": 256}, 1, "delay must be between 0 and 255, not 256"),
        ({"latency_clk": 10_241}, 1, "latency must be between 0 and 10240, not 10241"),
        ({"words": np.zeros(0, np.uint64)}, 1, r"words must be of shape .*, not \(0,\)"),
        ({"words": np.zeros((1, 2), np.uint64)}, 1, "words must have 1 parts .*, not 2"),
    ],
)
def test_what_cannot_be_is_refused(fields: dict, cycles: int, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        drive(Scenario(**fields), DEFAULT, cycles)


def test_a_plan_knows_its_lines() -> None:
    told = Scenario().plan(DEFAULT, 1)
    columns = {n: getattr(told, n) for n in ("latency", "length", "second", "second_length")}
    with pytest.raises(ValueError, match=r"a line must be one of line\.uef\.flip, .*, not line\.x"):
        Plan(config=DEFAULT, words=told.words, delay=told.delay, lines={"line.x": None}, **columns)
