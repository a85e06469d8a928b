"""Registers and stamps of the model, read back and held against the pins that made them."""

import itertools
import math
from dataclasses import fields, replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from railgate.odometer.host.readout import (
    Counts,
    Snapshot,
    Stamps,
    between,
    direction,
    distance_m,
    phase_deg,
    snapshots,
    stamps,
    window_edges,
)
from railgate.odometer.model import Model
from railgate.odometer.plant import Profile, Sensor, constant, shuttle
from railgate.odometer.spec import Config, Direction
from railgate.waves import Trace, Waveform

BLANK = Snapshot(**dict.fromkeys((field.name for field in fields(Snapshot)), 0))
SMALL = Config(sensors=1, count_bits=8, time_bits=24, stamp_depth=8)
EVERY_TICKS = 320_000


def played(
    profile: Profile, config: Config, ready: Waveform | None = None, rst: int = 0
) -> tuple[Trace, Trace]:
    """The pins of sensor 0 and what the model answers to a strobe every 20 ms."""
    pins = Sensor().drive(profile, config)
    at = np.arange(EVERY_TICKS, pins.end - 20, EVERY_TICKS)
    ticks = np.concatenate([[0], np.column_stack([at, at + 1]).ravel()])
    inputs = {f"sensor.0.{name}": wave for name, wave in pins.signals.items()}
    inputs["strobe"] = Waveform.of(ticks, np.arange(ticks.size) & 1)
    if config.stamp_depth:
        inputs["sensor.0.stamps.ready"] = ready or Waveform.of([0], [1])
    if rst:
        inputs["rst"] = Waveform.of([0, rst, rst + 1], [0, 1, 0])
    stimulus = Trace(inputs, pins.period, 0, pins.end)
    return pins, Model(config).advance(pins.end, stimulus)


def edges(pins: Trace, config: Config) -> list[int]:
    both = np.concatenate([pins["a"].ticks[1:], pins["b"].ticks[1:]])
    return (np.sort(both) + config.input_delay_ticks).tolist()


def test_a_snapshot_has_the_fields_of_the_specification() -> None:
    stated = [*Config().common_fields, *Config().sensor_fields]
    assert [field.name for field in fields(Snapshot)] == [field.name for field in stated]


@pytest.mark.shows("ODO-7")
def test_every_strobe_gives_one_snapshot_of_its_tick() -> None:
    config = Config(sensors=1)
    pins, outputs = played(constant(100, 0.5), config)
    shots = snapshots(outputs, config)
    assert [shot.number for shot in shots] == list(range(1, len(shots) + 1))
    assert [shot.time for shot in shots] == [EVERY_TICKS * shot.number for shot in shots]
    rises = pins["a"].rising() + config.input_delay_ticks
    for shot in shots:
        passed = rises[rises <= shot.time]
        assert shot.a_rising == passed.size
        assert shot.since_rise == shot.time - passed[-1]
        assert shot.period == passed[-1] - passed[-2]
        assert shot.causes == 0
        angle = phase_deg(shot)
        assert angle is not None
        assert abs(angle - 90) < 0.1


def test_a_reset_is_no_snapshot() -> None:
    config = Config(sensors=1)
    _, outputs = played(constant(100, 0.2), config, rst=5 * EVERY_TICKS // 2)
    assert [shot.number for shot in snapshots(outputs, config)] == [1, 2, 1, 2, 3, 4, 5, 6, 7]


@pytest.mark.shows("ODO-7")
@given(st.data())
def test_lost_replies_lose_nothing(data: st.DataObject) -> None:
    """Counters of 8 bits and a time of 24 wrap many times over the run (ODO-7)."""
    shots = WRAPPING
    kept = sorted(data.draw(st.sets(st.integers(0, len(shots) - 1), min_size=2)))
    kept = [0, *kept, len(shots) - 1]
    legs = [between(shots[i], shots[j], SMALL) for i, j in itertools.pairwise(kept)]
    if max(j - i for i, j in itertools.pairwise(kept)) > 5:
        return
    total = EVERY_TICKS * (len(shots) - 1)
    assert sum(leg.ticks for leg in legs) == total
    assert sum(leg.snapshots for leg in legs) == len(shots) - 1
    rises = RISES[(shots[0].time < RISES) & (shots[0].time + total >= RISES)]
    assert sum(leg.pulses for leg in legs) == rises.size
    assert abs(sum(leg.steps for leg in legs) + 4 * rises.size) <= 4


PINS, OUTPUTS = played(constant(-90, 3), SMALL)
WRAPPING = snapshots(OUTPUTS, SMALL)
RISES = PINS["a"].rising() + SMALL.input_delay_ticks


@pytest.mark.shows("ODO-6")
def test_steps_are_signed_and_wrap_either_way() -> None:
    older = replace(BLANK, position=127, direction_changes=255)
    newer = replace(BLANK, position=-128 + 9, direction_changes=1)
    assert between(older, newer, SMALL).steps == 10
    assert between(newer, older, SMALL).steps == -10
    assert between(older, newer, SMALL).direction_changes == 2


@pytest.mark.shows("ODO-13")
def test_stamps_are_the_edges_of_the_pins() -> None:
    pins, outputs = played(shuttle(60, 2), SMALL)
    taken = stamps(outputs, SMALL)
    assert taken.ticks.tolist() == edges(pins, SMALL)
    assert (taken.a == (pins["a"].at(taken.ticks - SMALL.input_delay_ticks) != 0)).all()
    assert (taken.b == (pins["b"].at(taken.ticks - SMALL.input_delay_ticks) != 0)).all()
    assert not taken.lost.any()


@pytest.mark.shows("ODO-13")
@pytest.mark.parametrize("pause", [2, 977, 5003])
def test_stamps_taken_by_fits_and_starts_are_the_same(pause: int) -> None:
    at = np.arange(0, 8_000_000 - 1, pause)
    ready = Waveform.of(np.column_stack([at, at + 1]).ravel(), np.arange(2 * at.size) & 1)
    pins, outputs = played(constant(60, 0.5), SMALL, ready)
    taken = stamps(outputs, SMALL, ready=ready)
    expected = edges(pins, SMALL)
    assert len(expected) - SMALL.stamp_depth <= taken.ticks.size <= len(expected)
    assert taken.ticks.tolist() == expected[: taken.ticks.size]


def test_a_stamp_only_offered_is_not_taken() -> None:
    never = Waveform.of([0], [0])
    _, outputs = played(constant(60, 0.1), SMALL, never)
    assert outputs["sensor.0.stamps.valid"].at(outputs.end - 1) == 1
    assert not stamps(outputs, SMALL, ready=never).ticks.size


@pytest.mark.shows("ODO-13")
def test_an_edge_after_a_loss_is_not_known_to_be_a_rise_of_a() -> None:
    low, high = np.zeros(4, bool), np.array([False, True, False, True])
    ticks = np.array([10, 20, 30, 40])
    assert Stamps(ticks, high, low, low).rises.tolist() == [20, 40]
    assert Stamps(ticks, high, low, ticks == 20).rises.tolist() == [40]


def test_stamps_unwrap_beyond_32_bits() -> None:
    ticks = np.array([2**32 - 5, 2**32 + 5, 2**35 + 100, 2**40])
    low = (ticks & 0xFFFF_FFFF) | (np.array([1, 0, 1, 0]) << 32)
    at = np.concatenate([[0], np.column_stack([ticks + 4, ticks + 5]).ravel()])
    word = np.concatenate([[0], np.column_stack([low, 0 * low]).ravel()])
    signals = {
        "sensor.0.stamps.valid": Waveform.of(at, np.arange(at.size) & 1),
        "sensor.0.stamps.payload": Waveform.of(at, word, 35),
    }
    taken = stamps(Trace(signals, Fraction(1, 16_000_000), 0, 2**41), SMALL)
    assert taken.ticks.tolist() == ticks.tolist()
    assert taken.rises.tolist() == [2**35 + 100]
    with pytest.raises(ValueError, match="stamp_depth of at least 1, not 0"):
        stamps(Trace(signals, Fraction(1, 16_000_000), 0, 2**41), Config())


def test_each_window_finds_its_edges_among_the_stamps() -> None:
    pins, outputs = played(constant(100, 0.5), SMALL)
    rises = (pins["a"].rising() + SMALL.input_delay_ticks).tolist()
    taken, shots = stamps(outputs, SMALL), snapshots(outputs, SMALL)
    for older, newer in itertools.pairwise(shots):
        found = window_edges(taken, newer, SMALL)
        assert found is not None
        first, last = older.time - older.since_rise, newer.time - newer.since_rise
        assert found.tolist() == [tick for tick in rises if first <= tick <= last]


def test_a_window_with_a_lost_stamp_has_no_edges() -> None:
    ready = Waveform.of([0, 3_000_000, 4_000_000], [1, 0, 1])
    _, outputs = played(constant(100, 0.5), SMALL, ready)
    taken = stamps(outputs, SMALL, ready=ready)
    assert taken.lost.sum() == 1
    shots = snapshots(outputs, SMALL)[1:]
    whole = [window_edges(taken, shot, SMALL) is not None for shot in shots]
    spans = [(shot.time - shot.since_rise - shot.window_ticks, shot.time) for shot in shots]
    for found, (first, last) in zip(whole, spans, strict=True):
        assert found == (last < 3_000_000 or first > 4_000_000)
    assert window_edges(taken, replace(shots[0], window_seated=0), SMALL) is None


@pytest.mark.shows("ODO-14")
def test_the_direction_is_the_wheels() -> None:
    _, outputs = played(shuttle(60, 2), Config(sensors=1))
    shots = snapshots(outputs, Config())
    seen = [direction(o, n, Config()) for o, n in itertools.pairwise(shots)]
    half = len(seen) // 2
    assert set(seen[: half - 3]) == {Direction.FORWARD}
    assert set(seen[half + 3 :]) == {Direction.REVERSE}
    turn = next(i for i, shot in enumerate(shots) if shot.direction_changes) - 1
    assert seen[turn] == Direction.NONE
    angle = phase_deg(shots[3 * len(shots) // 4])
    assert angle is not None
    assert abs(angle - 270) < 0.5


@pytest.mark.shows("ODO-14")
@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({}, Direction.FORWARD),
        ({"phase_direction": 0}, Direction.FORWARD),
        ({"phase_direction": 2}, Direction.NONE),
        ({"phase_direction": 2, "a_rising": 0}, Direction.FORWARD),
        ({"direction": 0}, Direction.NONE),
        ({"direction": 2}, Direction.NONE),
        ({"position": 0}, Direction.NONE),
        ({"direction_changes": 2}, Direction.NONE),
        ({"illegal_transitions": 1}, Direction.NONE),
    ],
)
def test_a_direction_needs_all_that_speak_to_agree(
    change: dict[str, int], expected: Direction
) -> None:
    newer = replace(BLANK, position=8, a_rising=2, direction=1, phase_direction=1)
    assert direction(BLANK, replace(newer, **change), Config()) == expected


@pytest.mark.shows("ODO-14")
def test_the_distance_does_not_drift() -> None:
    config = Config(wheel_diameter_m=Fraction(6499, 10_000))
    leg = Counts(320_000, 1, 25, 25, 101, 0, 0, 0)
    exact = distance_m(101 * 100_000, config)
    assert distance_m([leg] * 100_000, config) == exact
    assert exact == math.pi * float(Fraction(6499, 10_000) * 101 * 100_000 / 800)
    assert distance_m(-800, Config()) == -math.pi * 0.65


def test_no_valid_period_has_no_phase() -> None:
    assert phase_deg(replace(BLANK, period=3000, phase=750)) is None
