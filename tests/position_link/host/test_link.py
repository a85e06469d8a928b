"""Deliveries and summaries from outputs made by hand, cycle by cycle."""

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from railgate.position_link.host.health import summary
from railgate.position_link.host.layout import Bits, Layout, WordField
from railgate.position_link.host.layout_file import parse_layout
from railgate.position_link.host.link import Deliveries, deliveries, position_uncertainty_m
from railgate.position_link.spec import Cause, Config, Health, Status
from railgate.waves import Trace, Waveform

LAYOUT = parse_layout(
    """
    word_bits = 64
    zero_is_fault = true
    check = { kind = "crc", width = 8, polynomial = 0x2f, initial = 0xff, final = 0xff }
    field = [
        { name = "position", bits = "63..24", scale = 0.001, unit = "m" },
        { name = "speed", bits = "23..12", signed = true, scale = 0.25, unit = "km/h" },
        { name = "sequence", bits = "11..8", gray = true },
    ]
    """,
    "a layout",
)
LINK = LAYOUT.applied_to(Config())
WORD = LAYOUT.encode({"position": 1234.5, "speed": -60.25, "sequence": 6})
PLAIN = Layout(word_bits=64, fields=(WordField(name="n", bits=Bits(63, 0)),))

FRESH = {"status": Status.FRESH, "health": Health.OK, "word": WORD, "age": 0, "age_ticks": 7000}
HELD = {**FRESH, "status": Status.HELD, "health": Health.WARNING, "age": 1, "age_ticks": 807_000}
DOWN = {"status": Status.FAULT, "health": Health.ALARM, "age": 3, "age_ticks": 2_407_000}
BACK = {**DOWN, "health": Health.RECOVERING, "age": 0, "age_ticks": 7000}
START: dict[str, int] = {}


def outputs(rows: Sequence[dict[str, int]], config: Config, gap: int = 0) -> Trace:
    """The link's outputs where the deliveries are `rows`; what a row leaves out is as at start,
    but the number goes on. gap: ticks between delivery and fields, 0 in a sound link."""
    first, cycle = config.delivery_ticks + 1, config.cycle_ticks
    at = np.array([first + cycle * i for i in range(len(rows))], np.int64)
    pulses = np.concatenate([[0], np.column_stack([at, at + 1]).ravel()])
    signals = {"delivery": Waveform.of(pulses, np.arange(pulses.size) & 1)}
    ticks = np.concatenate([[0], at + gap])
    for field in config.fields:
        column = [field.start]
        for i, row in enumerate(rows, 1):
            column.append(row.get(field.name, i if field.name == "number" else field.start))
        for low in range(0, field.width, 64):
            name = f"{field.name}.{low // 64}" if field.width > 64 else field.name
            part = [value >> low & (1 << 64) - 1 for value in column]
            signals[name] = Waveform.of(ticks, part, min(64, field.width - low))
    return Trace(signals, Fraction(1, config.clock_hz), 0, first + cycle * (len(rows) + 1))


def read(
    rows: Sequence[dict[str, int]], config: Config = LINK, layout: Layout | None = LAYOUT
) -> Deliveries:
    return deliveries(outputs(rows, config), config, layout)


@pytest.mark.shows("LNK-8")
def test_a_fresh_word_is_read_in_engineering_units() -> None:
    run = read([FRESH])
    (one,) = run
    assert len(run) == 1
    assert one.tick == 1 + LINK.delivery_ticks
    assert one.time_s == one.tick / 40e6
    assert (one.number, one.word, one.age) == (1, WORD, 0)
    assert (one.status, one.health) == (Status.FRESH, Health.OK)
    assert one.age_s == 7000 / 40e6
    assert one.causes == ()
    assert one.values == {"position": 1234.5, "speed": -60.25, "sequence": 6}
    assert one.consistent


def test_a_held_word_keeps_its_values_and_says_its_age_and_why() -> None:
    one = read([FRESH, {**HELD, "causes": Cause.SHORT | Cause.UNSTABLE}])[1]
    assert (one.status, one.health, one.age) == (Status.HELD, Health.WARNING, 1)
    assert one.age_s == 807_000 / 40e6
    assert one.causes == ("short", "unstable")
    assert one.values["position"] == 1234.5


@pytest.mark.shows("LNK-5")
@pytest.mark.parametrize("word", [WORD, LINK.invalid_word, 0])
def test_with_status_fault_there_is_no_position_whatever_the_bits(word: int) -> None:
    run = read([{**DOWN, "word": word}, {**BACK, "word": word}, {"word": word}])
    for one in run:
        assert one.values == {}
        assert one.consistent == (word == LINK.invalid_word)
    for column in run.values.values():
        assert column.mask.all()
        assert not column.data.any()


@pytest.mark.shows("LNK-5")
@pytest.mark.parametrize("word", [LINK.invalid_word, 0, WORD ^ 1, WORD ^ 1 << 40])
@pytest.mark.parametrize("row", [FRESH, HELD])
def test_a_word_that_cannot_be_good_is_not_believed(row: dict[str, int], word: int) -> None:
    one = read([{**row, "word": word}])[0]
    assert not one.consistent
    assert one.values == {}


@pytest.mark.shows("LNK-7")
def test_without_a_check_any_word_is_believed_and_the_summary_says_so() -> None:
    run = read([{**FRESH, "word": WORD ^ 1 << 40}], Config(), PLAIN)
    assert run[0].values == {"n": WORD ^ 1 << 40}
    said = "without a check field a fault of DATA alone is not seen"
    assert summary(run).guarantee == said
    assert summary(read([FRESH])).guarantee != said


def test_a_status_or_health_of_no_meaning_is_the_worst_one() -> None:
    one, two = read([{**FRESH, "status": 3}, {**FRESH, "health": 5}])
    assert (one.status, one.consistent, one.values) == (Status.FAULT, False, {})
    assert (two.health, two.consistent, two.values) == (Health.ALARM, False, {})


def test_an_age_beyond_what_is_counted_is_none() -> None:
    never = (1 << LINK.age_ticks_bits) - 1
    run = read([START, {**DOWN, "age_ticks": never - 1}])
    assert [one.age_s for one in run] == [None, (never - 1) / 40e6]
    assert run.age_s.tolist() == [np.inf, (never - 1) / 40e6]


def test_only_what_stands_in_the_tick_of_the_delivery_counts() -> None:
    late = deliveries(outputs([FRESH, HELD], LINK, gap=1), LINK, LAYOUT)
    assert [one.status for one in late] == [Status.FAULT, Status.FRESH]


def test_no_delivery_is_a_run_too() -> None:
    run = read([])
    assert list(run) == []
    assert run.values["position"].shape == (0,)
    found = summary(run)
    assert (found.deliveries, found.availability, found.oldest_s) == (0, 0.0, None)
    assert (found.alarms, found.lost, found.faulty_cycles) == (0, 0, 0)


def test_a_run_cut_at_a_delivery_begins_with_it() -> None:
    trace = outputs([FRESH, HELD], LINK)
    cut = deliveries(trace.slice(1 + LINK.delivery_ticks, trace.end), LINK, LAYOUT)
    assert [one.number for one in cut] == [1, 2]


@given(st.integers(9, 512), st.data())
def test_words_of_any_length_are_put_together(bits: int, data: st.DataObject) -> None:
    config = Config(word_bits=bits)
    words = data.draw(st.lists(st.integers(0, (1 << bits) - 2), min_size=1, max_size=4))
    high = Bits(bits - 1, max(bits - 60, 0))
    rest = (Bits(high.lsb - 1, 0),) if high.lsb else ()
    layout = Layout(word_bits=bits, fields=(WordField(name="h", bits=high),), unused=rest)
    run = read([{**FRESH, "word": word} for word in words], config, layout)
    assert [one.word for one in run] == words
    assert run.values["h"].tolist() == [word >> high.lsb for word in words]
    assert run[-1] == run[len(words) - 1]


def test_lost_deliveries_and_resets_show_in_the_numbers() -> None:
    """With numbers of 8 bits that wrap; the run begins in the midst of it."""
    config = replace(LINK, count_bits=8)
    numbers = [253, 254, 1, 2, 2, 1, 3, 2, 255]
    run = read([{**FRESH, "number": number} for number in numbers], config)
    assert run.lost.tolist() == [0, 0, 2, 0, 1, 0, 1, 1, 254]
    assert run.restarted.tolist() == [False] * 4 + [True, True, False, True, True]
    assert not run.restarted[0]
    assert read([{**FRESH, "number": 0}] * 3, config).lost.tolist() == [0, 0, 0]
    found = summary(run)
    assert (found.restarts, found.lost) == (4, 259)
    assert found.availability == len(numbers) / (len(numbers) + 259)


@pytest.mark.shows("LNK-7")
def test_counts_grow_over_wraps_losses_and_resets() -> None:
    config = replace(LINK, count_bits=8)

    def row(number: int, short: int) -> dict[str, int]:
        return {**FRESH, "number": number, "short_cycles": short, "rejected_glitches": short // 2}

    from_reset = read([row(1, 1), row(2, 1), row(9, 5)], config)
    assert summary(from_reset).causes["short"] == 5
    assert from_reset.grown("rejected_glitches") == 2
    later = read([row(100, 250), row(110, 3), row(1, 0), row(2, 1)], config)
    assert later.grown("short_cycles") == 9 + 0 + 1
    assert summary(later).causes == {
        cause.name.lower(): 10 * (cause == Cause.SHORT) for cause in Cause if cause.name
    }


@pytest.mark.shows("LNK-7")
def test_a_summary_counts_states_and_alarms() -> None:
    rows: list[dict[str, int]] = [
        START, START, FRESH, HELD, HELD, DOWN, DOWN, BACK, FRESH, HELD, FRESH, DOWN, FRESH,
        {**FRESH, "word": 0}, {**HELD, "age_ticks": 1_607_000}, DOWN,
    ]  # fmt: skip
    found = summary(read([{**row, "faulty_cycles": i} for i, row in enumerate(rows, 1)]))
    assert (found.deliveries, found.fresh, found.held, found.fault) == (16, 4, 4, 8)
    assert (found.starting, found.inconsistent, found.lost, found.restarts) == (2, 1, 0, 0)
    assert found.availability == 0.5
    assert found.alarms == 3
    assert found.longest_alarm_s == 3 * 0.02
    assert found.oldest_s == 1_607_000 / 40e6
    assert found.faulty_cycles == 16


def test_recovering_without_an_alarm_is_none() -> None:
    assert summary(read([START, BACK, BACK, FRESH])).alarms == 0
    found = summary(read([START, BACK, DOWN, BACK, FRESH, HELD, DOWN, FRESH]))
    assert (found.alarms, found.longest_alarm_s) == (2, 3 * 0.02)


def test_an_alarm_lasts_over_lost_deliveries_and_to_the_end() -> None:
    run = read([FRESH, DOWN, DOWN, DOWN])
    assert (summary(run).alarms, summary(run).longest_alarm_s) == (1, 0.06)
    without = np.array([True, True, False, True])
    part = replace(
        run,
        ticks=run.ticks[without],
        words=run.words[without],
        fields={name: column[without] for name, column in run.fields.items()},
    )
    assert (summary(part).alarms, summary(part).longest_alarm_s) == (1, 0.06)
    assert summary(part).lost == 1


def test_without_a_layout_the_words_stay_words() -> None:
    one = read([FRESH], LINK, None)[0]
    assert (one.word, one.values, one.consistent) == (WORD, {}, True)


@pytest.mark.parametrize(
    ("settings", "error"),
    [
        ({"zero_is_fault": False}, "layout's zero_is_fault must be the link's, False, not True"),
        ({"check": None}, "layout's check must be the link's, None, not Check"),
        (
            {"fault_word": 5},
            "layout's invalid_word must be the link's, 5, not 18446744073709551615",
        ),
        ({"word_bits": 65}, "layout's word_bits must be the link's, 65, not 64"),
    ],
)
def test_a_layout_of_another_link_is_refused(settings: dict[str, Any], error: str) -> None:
    trace = outputs([FRESH], LINK)
    other = replace(LINK, **{"fault_word": None, **settings})
    with pytest.raises(ValueError, match=error):
        deliveries(trace, other, LAYOUT)


def test_a_fault_word_by_default_is_that_of_all_ones() -> None:
    assert read([FRESH], replace(LINK, fault_word=None))[0].consistent


def test_outputs_of_another_link_are_refused() -> None:
    trace = outputs([FRESH], LINK)
    with pytest.raises(ValueError, match='"age" must be 7 bits wide, not 6'):
        deliveries(trace, replace(LINK, age_bits=7), LAYOUT)
    with pytest.raises(ValueError, match="a tick must last 1/20000000 s, not 1/40000000 s"):
        deliveries(trace, replace(LINK, clock_hz=20_000_000), LAYOUT)
    with pytest.raises(ValueError, match='no channel "delivery"'):
        deliveries(trace.select(["word"]), LINK, LAYOUT)


def test_a_position_of_some_age_is_uncertain_by_the_way_since() -> None:
    assert position_uncertainty_m(0.06, 430) == pytest.approx(7.1667, abs=1e-4)
