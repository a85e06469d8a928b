"""What the gateware reads from the line, and each cause at its boundary, to the tick."""

import pytest

from position_link.line import (
    Piece,
    answer,
    begin,
    decision,
    deliveries,
    fields,
    opened,
    run,
    small,
    stimulus,
)
from railgate.position_link.spec import EVEN, ODD, Cause, Check, Config, Edge, Health, Status

WORD = 0xA5
NONE = Cause(0)


def causes(config, cycles, *pieces):
    """Those of each cycle."""
    return [Cause(one["causes"]) for one in deliveries(config, run(config, cycles, *pieces))]


def first(config, *pieces):
    """Causes and word of the first cycle; its delivery is fresh if and only if it has no cause."""
    (one,) = deliveries(config, run(config, 1, *pieces))
    assert (one["status"] == Status.FRESH) == (one["causes"] == 0)
    return Cause(one["causes"]), one["word"]


@pytest.mark.shows("LNK-4")
def test_no_answer_is_a_timeout_and_no_word():
    assert first(small()) == (Cause.TIMEOUT, 0xFF)


@pytest.mark.shows("LNK-4")
@pytest.mark.parametrize("from_end", [False, True])
def test_the_last_tick_of_the_window_is_in_time_and_the_next_is_not(from_end):
    config = small(timeout_from_end=from_end)
    last = config.timeout_bits + 3 * from_end
    assert first(config, answer(config, 0, WORD, last - 1)) == (NONE, WORD)
    assert first(config, answer(config, 0, WORD, last, delay=-1)) == (NONE, WORD)
    late = Cause.TIMEOUT | Cause.UNREQUESTED
    assert first(config, answer(config, 0, WORD, last)) == (late, 0xFF)


@pytest.mark.shows("LNK-4")
def test_uef_with_clk_30_is_in_time_and_with_clk_31_is_not():
    config = Config()
    late = Cause.TIMEOUT | Cause.UNREQUESTED
    for at_bit, delay, cause in ((29, 0, NONE), (30, -1, NONE), (30, 0, late)):
        piece = answer(config, 0, 0x1234_5678_9ABC_DEF0, at_bit, delay=delay)
        (one,) = deliveries(config, run(config, 1, piece, kind="cxxrtl"))
        assert (one["causes"], one["status"] == Status.FRESH) == (cause, not cause)


@pytest.mark.shows("LNK-4")
def test_before_its_earliest_clk_uef_is_early_up_to_the_tick_in_which_the_window_opens():
    config = small(earliest_clk=3)
    assert first(config, answer(config, 0, WORD, 2, delay=-1)) == (Cause.EARLY, 0xFF)
    assert first(config, answer(config, 0, WORD, 2)) == (NONE, WORD)


@pytest.mark.shows("LNK-4")
def test_early_uef_is_followed_by_no_timeout_and_a_later_answer_is_read_but_not_good():
    config = small(earliest_clk=3)
    early = Piece(uef=((begin(config, 0), begin(config, 0) + 5),))
    assert first(config, early) == (Cause.EARLY, 0xFF)
    assert first(config, early, answer(config, 0, WORD, 3)) == (Cause.EARLY, 0xFF)


@pytest.mark.shows("LNK-4")
def test_the_window_may_open_with_the_cycle_and_the_tick_before_belongs_to_the_last():
    config = small(earliest_clk=1)
    assert first(config, answer(config, 0, WORD, 0)) == (NONE, WORD)
    assert causes(config, 2, answer(config, 0, WORD, 1), answer(config, 1, WORD, 0)) == [NONE] * 2
    before = answer(config, 1, WORD, 0, delay=-1)
    stuck = Cause.STUCK | Cause.UNREQUESTED
    assert causes(config, 2, answer(config, 0, WORD, 1), before) == [NONE, stuck]


@pytest.mark.shows("LNK-3", "LNK-4")
@pytest.mark.parametrize(("bits", "cause"), [(7, Cause.SHORT), (8, NONE), (9, Cause.LONG)])
def test_uef_lasts_exactly_the_word(bits, cause):
    config = small()
    assert first(config, answer(config, 0, WORD, 2, bits)) == (cause, 0xFF if cause else WORD)


@pytest.mark.shows("LNK-3")
def test_a_sample_in_the_tick_of_uefs_rise_counts_and_in_that_of_its_fall_does_not():
    config = small(guard_ticks=0)
    middle = begin(config, 0) + config.fall(2)
    data = ((middle, begin(config, 0) + config.rise(3)),)

    def read(start, stop):
        span = (middle + start, begin(config, 0) + config.fall(9) + stop)
        return first(config, Piece(uef=(span,), data=data))

    assert read(0, 1) == (NONE, 0x80)
    assert read(0, 0)[0] == Cause.SHORT
    assert read(1, 1)[0] == Cause.SHORT
    assert read(-1, 10) == (NONE, 0x80)
    assert read(-1, 11)[0] == Cause.LONG


@pytest.mark.shows("LNK-4")
def test_uef_that_is_still_high_at_the_next_request_is_stuck():
    config = small()
    long = answer(config, 0, WORD, 2, bits=config.cycle_bits)
    assert causes(config, 2, long) == [Cause.LONG, Cause.STUCK]
    good = answer(config, 1, WORD, 4)
    assert causes(config, 3, long, good) == [Cause.LONG, Cause.STUCK, Cause.TIMEOUT]
    to_start = Piece(uef=((begin(config, 0) + config.rise(2), begin(config, 1)),))
    assert causes(config, 2, to_start, good) == [Cause.LONG, NONE]


@pytest.mark.shows("LNK-4")
@pytest.mark.parametrize("level", [0, 1])
def test_an_unplugged_line_is_a_fault_in_every_cycle(level):
    config = small()
    end = begin(config, 3)
    for data in (0, 1):
        piece = Piece(uef=((0, level * end),), data=((0, data * end),))
        seen = deliveries(config, run(config, 3, piece))
        assert [one["causes"] for one in seen] == [Cause.STUCK if level else Cause.TIMEOUT] * 3
        assert {one["word"] for one in seen} == {0xFF}
        assert [one["health"] for one in seen] == [Health.START, Health.START, Health.ALARM]


@pytest.mark.shows("LNK-4")
def test_a_second_answer_makes_the_cycle_faulty_in_which_it_is_decided():
    config = small()
    good = answer(config, 0, WORD, 2)

    def second(tick):
        return Piece(uef=((tick, tick + 10),))

    last = decision(config, 0) - config.input_delay_ticks
    assert causes(config, 2, good, second(last)) == [Cause.UNREQUESTED, Cause.TIMEOUT]
    after = Cause.UNREQUESTED | Cause.TIMEOUT
    assert causes(config, 2, good, second(last + 1)) == [NONE, after]
    within = answer(config, 0, 0, 2, bits=1), answer(config, 0, WORD, 4)
    assert first(config, *within)[0] == Cause.SHORT | Cause.UNREQUESTED


@pytest.mark.shows("LNK-4")
def test_uef_without_a_request_before_it_is_unrequested():
    config = small()
    late = answer(config, 0, WORD, 30)
    again = answer(config, 1, WORD, 2)
    assert causes(config, 2, late, again) == [Cause.TIMEOUT, Cause.UNREQUESTED]


@pytest.mark.shows("LNK-7")
@pytest.mark.parametrize("guard_ticks", [0, 1, 2])
@pytest.mark.parametrize("rises", [False, True])
def test_data_that_changes_within_the_guard_around_its_sample_is_unstable(guard_ticks, rises):
    """The fourth bit is sampled in the tick of the change, `offset` before or after it."""
    config = small(guard_ticks=guard_ticks)
    c = begin(config, 0)
    for offset in range(-4, 5):
        change, stop = c + config.fall(5) + offset, c + config.rise(10)
        data = (change, stop) if rises else (0, change)
        uef = (c + config.rise(2), stop)
        new = 0b00011111 if rises else 0b11100000
        word = new if offset <= 0 else new ^ 0b00010000
        unstable = -guard_ticks < offset <= guard_ticks
        expected = (Cause.UNSTABLE, 0xFF) if unstable else (NONE, word)
        assert first(config, Piece(uef=(uef,), data=(data,))) == expected


def test_data_that_changes_around_the_bit_too_many_is_not_unstable():
    config = small()
    c = begin(config, 0)
    change = Piece(data=((c + config.fall(10), c + config.rise(11)),))
    assert first(config, answer(config, 0, 0, 2, bits=9), change)[0] == Cause.LONG


@pytest.mark.shows("LNK-3")
def test_data_may_do_what_it_wants_while_there_is_no_answer():
    config = small()
    c = begin(config, 0)
    noise = tuple((c + config.fall(n), c + config.fall(n + 1)) for n in range(11, 70, 2))
    assert causes(config, 2, answer(config, 0, WORD, 2), Piece(data=noise))[0] == NONE


def test_with_rising_edges_it_samples_in_their_tick():
    config = small(sampling_edge=Edge.RISING, guard_ticks=2)
    assert first(config, answer(config, 0, WORD, 2, delay=5)) == (NONE, WORD)
    assert first(config, answer(config, 0, WORD, 2, delay=-2)) == (NONE, WORD)
    assert first(config, answer(config, 0, WORD, 2, delay=-1))[0] == Cause.UNSTABLE
    for bits, cause in ((7, Cause.SHORT), (9, Cause.LONG)):
        assert first(config, answer(config, 0, WORD, 2, bits, delay=5))[0] == cause


@pytest.mark.shows("LNK-3")
@pytest.mark.parametrize("filter_ticks", [0, 1, 3])
def test_a_glitch_as_long_as_the_filter_is_counted_and_one_longer_ends_the_answer(filter_ticks):
    config = small(filter_ticks=filter_ticks, word_bits=8)
    whole = answer(config, 0, WORD, 2)
    ((start, stop),) = whole.uef
    hole = start + 33

    def with_hole(length):
        uef = ((start, hole), (hole + length, stop))
        (one,) = deliveries(config, run(config, 1, Piece(uef=uef, data=whole.data)))
        return Cause(one["causes"]), one["rejected_glitches"]

    if filter_ticks:
        assert with_hole(filter_ticks) == (NONE, 1)
    assert with_hole(filter_ticks + 1) == (Cause.SHORT | Cause.UNREQUESTED, 0)


def test_glitches_of_both_inputs_count_and_those_after_the_decision_with_the_next_delivery():
    config = small()
    good = [answer(config, c, WORD, 2) for c in range(2)]

    def counts(*ticks):
        """Of glitches that the filters tell in these ticks: they are gone three ticks before."""
        spans = tuple((tick - 3, tick - 2) for tick in ticks)
        seen = deliveries(config, run(config, 2, *good, Piece(uef=spans, data=spans)))
        assert {one["causes"] for one in seen} == {0}
        return [one["rejected_glitches"] for one in seen]

    q = decision(config, 0)
    assert counts(q) == [2, 2]
    assert counts(q + 1) == [0, 2]
    assert counts(*range(q - 8, q + 12, 2)) == [10, 20]


@pytest.mark.shows("LNK-3")
def test_an_answer_counts_from_where_it_is_on_the_line_whatever_the_filter():
    for filter_ticks in (0, 3, 4):
        config = small(filter_ticks=filter_ticks, guard_ticks=0)
        assert first(config, answer(config, 0, WORD, config.timeout_bits, delay=-1)) == (NONE, WORD)
        assert first(config, answer(config, 0, WORD, 2, delay=4)) == (NONE, WORD)
        assert first(config, answer(config, 0, WORD, 2, delay=5)) == (NONE, WORD)


@pytest.mark.shows("LNK-5")
def test_the_fault_word_and_where_configured_zero_are_no_words():
    config = small(fault_word=0x3C)
    assert first(config, answer(config, 0, 0x3C, 2)) == (Cause.FAULT_WORD, 0x3C)
    assert first(config, answer(config, 0, 0x3D, 2)) == (NONE, 0x3D)
    assert first(config, answer(config, 0, 0xFF, 2)) == (NONE, 0xFF)
    assert first(config, answer(config, 0, 0, 2)) == (NONE, 0)
    config = small(zero_is_fault=True)
    assert first(config, answer(config, 0, 0, 2)) == (Cause.ZERO_WORD, 0xFF)
    assert first(config, answer(config, 0, 1, 2)) == (NONE, 1)
    config = small(zero_is_fault=True, fault_word=0)
    assert first(config, answer(config, 0, 0, 2))[0] == Cause.ZERO_WORD | Cause.FAULT_WORD


CHECKS = (EVEN, ODD, Check(width=4, polynomial=0b0011, initial=0b1010, final=0b0110))
EVEN_POLYNOMIAL = Check(width=3, polynomial=0b010, initial=0b101)


@pytest.mark.shows("LNK-7")
@pytest.mark.parametrize("check", [*CHECKS, EVEN_POLYNOMIAL])
def test_a_word_whose_check_fails_is_no_word(check):
    config = small(check=check, fault_word=0)
    payload = 0b1011001 >> check.width - 1
    word = payload << check.width | check.of(payload, 8 - check.width)
    assert first(config, answer(config, 0, word, 2)) == (NONE, word)
    for bit in range(check.width):
        assert first(config, answer(config, 0, word ^ 1 << bit, 2)) == (Cause.CHECK, 0)
    if check is not EVEN_POLYNOMIAL:
        assert first(config, answer(config, 0, word ^ 0x80, 2)) == (Cause.CHECK, 0)


@pytest.mark.shows("LNK-7")
def test_a_check_starts_anew_with_every_answer():
    config = small(check=CHECKS[2])
    word = 0x70 | CHECKS[2].of(0x7, 4)
    torn = answer(config, 0, word, 2, bits=5)
    answers = [answer(config, cycle, word, 2) for cycle in (1, 2)]
    assert causes(config, 3, torn, *answers) == [Cause.SHORT, NONE, NONE]


def test_what_an_incomplete_word_holds_is_no_cause():
    config = small(check=ODD, zero_is_fault=True)
    assert first(config, answer(config, 0, 0, 2, bits=7)) == (Cause.SHORT, 0xFF)
    assert first(config, answer(config, 0, 0xFF, 2, bits=9)) == (Cause.LONG, 0xFF)


@pytest.mark.parametrize("tick", [5, 60, 141, 168, 300])
def test_reset_makes_a_new_tick_0_wherever_it_comes(tick):
    config = small()
    pieces = [answer(config, 0, WORD, 2), Piece(uef=((tick + 50, tick + 130),))]
    engine, start = opened(config, "pysim")
    end = tick + 1 + begin(config, 1)
    inputs = stimulus(config, pieces, end, reset=((tick, tick + 1),))
    engine.restore(start)
    after = engine.advance(end, inputs).slice(tick + 1, end).shift(-tick - 1)
    engine.restore(start)
    fresh = inputs.slice(tick + 1, end).shift(-tick - 1)
    assert after == engine.advance(fresh.end, fresh)
    assert fields(config, after, 0) == {field.name: field.start for field in config.fields}
