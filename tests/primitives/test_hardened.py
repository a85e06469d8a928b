"""Hardened registers: what they hold, and that every flipped bit shows."""

from enum import IntEnum
from fractions import Fraction
from itertools import combinations

import pytest

from railgate.engines import Clock, Design, open_engine
from railgate.primitives import SparseState, Twin
from railgate.waves import Trace, Waveform

pytestmark = pytest.mark.shows("DRV-16")

WIDTH = 5


class Four(IntEnum):
    A = 0
    B = 1
    C = 2
    D = 3


class Seven(IntEnum):
    A = 0
    B = 1
    C = 2
    D = 3
    E = 4
    F = 5
    G = 6


def opened(component, kind):
    clock = Clock(frequency_hz=Fraction(1))
    return open_engine(Design(name="hardened", component=component, clocks=(clock,)), kind)


def advanced(engine, values, width):
    """The outputs while `next` is one of the values in each tick, from now on."""
    start, end = engine.now, engine.now + len(values)
    wave = Waveform.of(range(start, end), values, width)
    return engine.advance(end, Trace({"next": wave}, Fraction(1), start, end))


def told(result, name, at):
    return int(result[name].at(at))


every_engine = pytest.mark.parametrize("kind", ["pysim", "cxxrtl"])


@every_engine
def test_a_twin_holds_what_was_next_and_starts_as_told(kind):
    values = [3, 0, 31, 31, 16, 1]
    result = advanced(opened(lambda: Twin(WIDTH, 9), kind), values, WIDTH)
    assert [told(result, "value", k) for k in range(6)] == [9, *values[:-1]]
    assert [told(result, "error", k) for k in range(6)] == [0] * 6


@every_engine
@pytest.mark.parametrize("name", ["value_copy", "inverse_copy"])
@pytest.mark.parametrize("bit", range(WIDTH))
def test_a_twin_tells_every_flipped_bit_of_either_copy_until_it_is_written(kind, name, bit):
    engine = opened(lambda: Twin(WIDTH), kind)
    advanced(engine, [0b10110], WIDTH)
    held = {"value_copy": 0b10110, "inverse_copy": 0b01001}[name]
    engine.poke(name, held ^ 1 << bit)
    result = advanced(engine, [7, 7], WIDTH)
    assert [told(result, "error", k) for k in (1, 2)] == [1, 0]
    assert told(result, "value", 2) == 7


@every_engine
@pytest.mark.parametrize("states", [Four, Seven])
def test_a_sparse_state_holds_what_was_next_and_starts_as_told(kind, states):
    values = [*states, *reversed(states)]
    width = max(states).bit_length()
    engine = opened(lambda: SparseState(states, states.C), kind)
    result = advanced(engine, values, width)
    assert [told(result, "value", k) for k in range(len(values))] == [2, *values[:-1]]
    assert result["error"].values.tolist() == [0]


@pytest.mark.parametrize(("states", "bits"), [(Four, 6), (Seven, 6)])
def test_a_sparse_state_tells_every_one_or_two_flipped_bits(states, bits):
    engine = opened(lambda: SparseState(states, states.A), "pysim")
    width = max(states).bit_length()
    codes = set()
    for state in states:
        advanced(engine, [state], width)
        start = engine.checkpoint()
        for code in range(1 << bits):
            engine.restore(start)
            engine.poke("code", code)
            result = advanced(engine, [state], width)
            if not told(result, "error", engine.now - 1):
                codes.add(code)
                assert told(result, "value", engine.now - 1) in list(states)
        engine.restore(start)
    assert len(codes) == len(states)
    assert all((a ^ b).bit_count() >= 3 for a, b in combinations([0, *codes], 2))


def test_a_number_that_is_no_state_becomes_an_error():
    result = advanced(opened(lambda: SparseState(Seven, Seven.A), "pysim"), [6, 7, 0, 0], 3)
    assert [told(result, "error", k) for k in range(4)] == [0, 0, 1, 0]
