"""What the gateware makes of good and faulty cycles: state, word, ages and counts."""

from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from position_link.line import (
    Piece,
    answer,
    begin,
    deliveries,
    opened,
    run,
    small,
    stimulus,
)
from railgate.engines import Clock, Design, open_engine
from railgate.position_link.gateware.supervision import Supervision
from railgate.position_link.spec import Cause, Health, Status
from railgate.waves import Trace, Waveform

FAULT, HELD, FRESH = Status
START, OK, WARNING, ALARM, RECOVERING = Health


def supervised(config, cycles):
    """Status, health, word less 0x40 and age of each cycle: `g` is answered with 0x40 + its number,
    `b` is not."""
    pieces = [answer(config, c, 0x40 + c, 2) for c, kind in enumerate(cycles) if kind == "g"]
    seen = deliveries(config, run(config, len(cycles), *pieces))
    return [(one["status"], one["health"], one["word"] - 0x40, one["age"]) for one in seen]


NO_WORD = 0xFF - 0x40
NEVER = 63


@pytest.mark.shows("LNK-5", "LNK-6")
def test_a_good_word_after_two_faulty_cycles_never_left():
    assert supervised(small(), "gbbg") == [
        (FRESH, OK, 0, 0),
        (HELD, WARNING, 0, 1),
        (HELD, WARNING, 0, 2),
        (FRESH, OK, 3, 0),
    ]


@pytest.mark.shows("LNK-5")
def test_three_faulty_cycles_in_a_row_bring_the_fault_word_and_the_first_good_one_ends_it():
    assert supervised(small(), "gbbbbg") == [
        (FRESH, OK, 0, 0),
        (HELD, WARNING, 0, 1),
        (HELD, WARNING, 0, 2),
        (FAULT, ALARM, NO_WORD, 3),
        (FAULT, ALARM, NO_WORD, 4),
        (FRESH, OK, 5, 0),
    ]


@pytest.mark.shows("LNK-5")
def test_faulty_cycles_that_are_not_in_a_row_do_not_add_up():
    assert [status for status, *_ in supervised(small(), "gbbgbbg")] == [
        *(FRESH, HELD, HELD),
        *(FRESH, HELD, HELD),
        FRESH,
    ]


@pytest.mark.shows("LNK-5")
def test_before_the_first_good_word_there_is_the_fault_word_and_the_alarm_comes_as_ever():
    assert supervised(small(), "bbbbg") == [
        *[(FAULT, START, NO_WORD, NEVER)] * 2,
        *[(FAULT, ALARM, NO_WORD, NEVER)] * 2,
        (FRESH, OK, 4, 0),
    ]


@pytest.mark.shows("LNK-5")
def test_with_one_cycle_tolerated_the_first_faulty_one_is_the_alarm():
    assert supervised(small(tolerated_cycles=1), "gbg") == [
        (FRESH, OK, 0, 0),
        (FAULT, ALARM, NO_WORD, 1),
        (FRESH, OK, 2, 0),
    ]


@pytest.mark.shows("LNK-5")
def test_recovery_takes_as_many_good_cycles_in_a_row_as_configured():
    config = small(recovery_cycles=3, tolerated_cycles=2)
    assert supervised(config, "bggbgggbb") == [
        (FAULT, START, NO_WORD, NEVER),
        (FAULT, RECOVERING, NO_WORD, 0),
        (FAULT, RECOVERING, NO_WORD, 0),
        (FAULT, ALARM, NO_WORD, 1),
        (FAULT, RECOVERING, NO_WORD, 0),
        (FAULT, RECOVERING, NO_WORD, 0),
        (FRESH, OK, 6, 0),
        (HELD, WARNING, 6, 1),
        (FAULT, ALARM, NO_WORD, 2),
    ]


@pytest.mark.shows("LNK-6")
def test_a_held_word_is_that_of_the_last_good_cycle_not_the_one_received():
    config = small(zero_is_fault=True)
    pieces = [answer(config, c, word, 2) for c, word in enumerate((0x12, 0x00, 0xFF, 0x00))]
    seen = deliveries(config, run(config, 4, *pieces))
    assert [one["word"] for one in seen] == [0x12, 0x12, 0x12, 0xFF]


@pytest.mark.shows("LNK-7")
def test_age_ticks_are_those_since_uefs_pin_rose_for_the_last_good_cycle():
    config = small(recovery_cycles=2, tolerated_cycles=1)
    pieces = [answer(config, c, 0x42, 2 + c, delay=c) for c in (1, 2)]
    ages = [one["age_ticks"] for one in deliveries(config, run(config, 5, *pieces))]
    (rise, _), (later, _) = (piece.uef[0] for piece in pieces)
    p = [begin(config, c) + config.delivery_ticks for c in range(5)]
    assert ages == [(1 << 32) - 1, p[1] - rise, p[2] - later, p[3] - later, p[4] - later]


@pytest.mark.shows("LNK-7")
def test_a_faulty_answer_does_not_make_the_data_younger():
    config = small()
    pieces = answer(config, 0, 0x42, 2), answer(config, 1, 0x42, 3, bits=9)
    first, second = deliveries(config, run(config, 2, *pieces))
    assert second["age_ticks"] - first["age_ticks"] == config.cycle_ticks


@pytest.mark.shows("LNK-7")
def test_ages_stay_at_their_greatest_value():
    config = small(age_bits=2, age_ticks_bits=16)
    assert [age for *_, age in supervised(config, "gbbbbb")] == [0, 1, 2, 3, 3, 3]
    engine, start = opened(config, "pysim")
    greatest = (1 << 16) - 1
    for before, after in ((-1, -1), (0, 0), (1, 0)):
        engine.restore(start)
        engine.poke("supervision.age_ticks", greatest - config.cycle_ticks + before)
        end = begin(config, 1)
        (one,) = deliveries(config, engine.advance(end, stimulus(config, [], end)))
        assert one["age_ticks"] == greatest + after


@pytest.mark.shows("LNK-7")
def test_an_answer_older_than_age_ticks_can_tell_is_of_the_greatest_age():
    config = small(age_ticks_bits=16, clock_hz=500_000_000)
    supervision = Design(
        name="supervision",
        component=lambda: Supervision(config),
        clocks=(Clock(frequency_hz=Fraction(1)),),
    )
    width = config.delivery_ticks.bit_length()
    for since, age_ticks in (((1 << 16) - 2, (1 << 16) - 2), (1 << 16, (1 << 16) - 1)):
        waves = {"good": Waveform.of([0], [1]), "publish": Waveform.of([0, 5, 6], [0, 1, 0])}
        waves["since_rise"] = Waveform.of([0], [since], width)
        result = open_engine(supervision, "pysim").advance(9, Trace(waves, Fraction(1), 0, 9))
        assert result["age_ticks"].at(6) == age_ticks


@pytest.mark.shows("LNK-7")
def test_each_cause_is_counted_once_a_cycle_and_counts_wrap():
    config = small(count_bits=8)
    many = Piece(uef=tuple((tick, tick + 4) for tick in range(100, 140, 8)))
    engine, start = opened(config, "pysim")
    engine.restore(start)
    wrapping = ("number", "faulty_cycles", "early_cycles", "unrequested_cycles")
    for name in wrapping:
        engine.poke(f"supervision.count_{name}.value", 255)
    end = begin(config, 2)
    first, second = deliveries(config, engine.advance(end, stimulus(config, [many], end)))
    assert first["causes"] == Cause.TIMEOUT | Cause.UNREQUESTED
    assert second["causes"] == Cause.TIMEOUT
    assert [first[name] for name in wrapping] == [0, 0, 255, 0]
    assert [second[name] for name in wrapping] == [1, 1, 255, 0]
    assert [first["timeout_cycles"], second["timeout_cycles"]] == [1, 2]


@pytest.mark.shows("LNK-4", "LNK-6")
@settings(max_examples=8, deadline=None)
@given(
    gaps=st.lists(st.tuples(st.integers(1, 90), st.integers(1, 90)), max_size=40),
    answered=st.sets(st.integers(0, 2)),
)
def test_whatever_uef_does_a_fresh_word_has_no_cause_and_every_cycle_its_delivery(gaps, answered):
    config = small(zero_is_fault=True)
    spans, tick = [], 0
    for low, length in gaps:
        spans.append((tick + low, tick + low + length))
        tick = spans[-1][1]
    pieces = [answer(config, c, 0x42 + c, 3) for c in answered]
    seen = deliveries(config, run(config, 3, Piece(uef=tuple(spans)), *pieces))
    assert len(seen) == 3
    for one in seen:
        assert (one["status"] == FRESH) == (not one["causes"] and one["age"] == 0)
        assert (one["status"] == FAULT) == (one["word"] == 0xFF)
        assert (one["status"] == FAULT) == (one["health"] in (START, ALARM, RECOVERING))


@pytest.mark.shows("LNK-5")
def test_a_reset_in_mid_word_forgets_the_cycles_before_it():
    """Good, two faulty, then a reset while the next answer comes: all begins anew."""
    config = small(tolerated_cycles=4, recovery_cycles=2)
    tick = begin(config, 3) + config.rise(6) + 1
    before = [answer(config, c, 0x40, 2) for c in (0, 1, 3)]
    first = stimulus(config, before, tick + 1, reset=((tick, tick + 1),))
    after = stimulus(config, [answer(config, c, 0x50 + c, 2) for c in (0, 1)], begin(config, 3))
    engine, start = opened(config, "pysim")
    engine.restore(start)
    inputs = first.concatenate(after.shift(tick + 1))
    shifted = engine.advance(inputs.end, inputs).slice(tick + 1, inputs.end).shift(-tick - 1)
    assert [
        (one["status"], one["health"], one["number"]) for one in deliveries(config, shifted)
    ] == [(FAULT, RECOVERING, 1), (FRESH, OK, 2), (HELD, WARNING, 3)]
    engine.restore(start)
    assert shifted == engine.advance(after.end, after)
