"""A captured line is read as the link reads it, and as far as the capture goes."""

from dataclasses import replace
from fractions import Fraction
from functools import cache

import pytest
from hypothesis import HealthCheck, given, settings

from position_link.stimuli import Answer, draw_answer, quiet, short, stimuli, trace
from railgate.position_link import model
from railgate.position_link.model import Model, Reading, read_line
from railgate.position_link.spec import Cause, Config
from railgate.waves import Trace, Waveform

random = settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow])


@random
@given(stimuli())
def test_reads_what_the_link_reads(case: tuple[Config, Trace]) -> None:
    config, stimulus = case
    line = stimulus.select(["uef", "data"])
    names = ("clk", "anf", "delivery", "causes")
    outputs = Model(config).advance(line.end, line, names)
    reading = read_line(
        outputs["clk"],
        line["uef"],
        line["data"],
        config,
        line.period,
        (line.start, line.end),
        outputs["anf"],
        config.filter_ticks,
    )
    told = outputs["causes"].at(outputs["delivery"].rising())
    late = int(Cause.UNREQUESTED)  # after a decision the link counts it to the next cycle
    assert [answer.causes & ~late for answer in reading] == [int(c) & ~late for c in told]


LINK = Config()
WORDS = [0x0123_4567_89AB_CDEF, 0, 0x8000_0000_0000_0001, (1 << 64) - 2, 42]


@cache
def line() -> Trace:
    """Five answers at 40 MHz, with 12 CLK from request to answer."""
    levels = quiet(LINK, 5)
    for cycle, word in enumerate(WORDS):
        draw_answer(LINK, levels, cycle, Answer(12, word))
    pins = trace(LINK, levels).select(["uef", "data"])
    return pins.merge(Model(LINK).advance(pins.end, pins, ["clk", "anf"]))


def read(
    capture: Trace, requests: bool = True, config: Config = LINK, filter_ticks: int = 0
) -> Reading:
    return read_line(
        capture["clk"],
        capture["uef"],
        capture["data"],
        config,
        capture.period,
        (capture.start, capture.end),
        capture["anf"] if requests else None,
        filter_ticks,
    )


def changed(capture: Trace, name: str, start: int, end: int, level: int) -> Trace:
    """The capture with one signal held at a level for a while."""
    wave = capture[name]
    ticks = [*wave.ticks[wave.ticks < start], start, end, *wave.ticks[wave.ticks > end]]
    before, after = wave.values[wave.ticks < start], wave.values[wave.ticks > end]
    values = [*before, level, wave.at(end), *after]
    return Trace(
        {**capture.signals, name: Waveform.of(ticks, values)}, capture.period, 0, capture.end
    )


@pytest.mark.parametrize("requests", [True, False])
@pytest.mark.parametrize("rate", [24_000_000, 10_000_000, 100_000_000])
def test_a_logic_analyser_of_any_rate_sees_every_word(requests: bool, rate: int) -> None:
    capture = line().resample(Fraction(1, rate))
    reading = read(capture, requests)
    assert [answer.word for answer in reading] == WORDS
    assert [answer.causes for answer in reading] == [Cause(0)] * 5
    assert [answer.bits for answer in reading] == [64] * 5
    assert (reading.requests, reading.cut, reading.clock_stops) == (requests, 0, 0)
    assert reading.bit_rate_hz == pytest.approx(512_000, rel=1e-5)
    rises = capture["uef"].rising().tolist()
    ticks = capture["anf"].rising().tolist() if requests else rises
    assert reading.ticks.tolist() == ticks
    assert [answer.rise for answer in reading] == rises
    assert [answer.fall for answer in reading] == capture["uef"].falling().tolist()


@pytest.mark.parametrize("requests", [True, False])
def test_an_answer_that_is_cut_off_is_no_fault(requests: bool) -> None:
    rises = line()["uef"].rising()
    reading = read(line().slice(int(rises[0]) + 1000, int(rises[-1]) + 1000), requests)
    assert [answer.word for answer in reading] == WORDS[1:-1]
    assert not reading.causes.any()
    assert reading.cut == (1 if requests else 2)


def test_what_comes_before_the_first_request_is_left_out() -> None:
    rise = int(line()["uef"].rising()[0])
    reading = read(line().slice(rise - 500, line().end))
    assert [answer.word for answer in reading] == WORDS[1:]
    assert not reading.causes.any()


def test_the_last_cycle_counts_once_its_decision_is_seen() -> None:
    begin = int(line()["anf"].rising()[-1])
    decided = begin + LINK.rise(LINK.window_bits + LINK.word_bits + 1)
    assert len(read(line().slice(0, decided))) == 4
    assert len(read(line().slice(0, decided + 1))) == 5


@pytest.mark.parametrize("skew", [-2, 0, 2])
def test_the_window_is_counted_from_the_clock_that_rises_with_the_request(skew: int) -> None:
    request = int(line()["anf"].rising()[1])
    inside, outside = (request + LINK.rise(LINK.window_bits) + shift for shift in (-1, 0))
    early, on_time = (request + LINK.rise(LINK.earliest_clk - 1) + shift for shift in (-1, 0))
    late = Cause.TIMEOUT | Cause.UNREQUESTED
    for rise, cause in ((inside, 0), (outside, late), (early, Cause.EARLY), (on_time, 0)):
        first, last = line()["uef"].rising()[1], line()["uef"].falling()[1]
        pulsed = changed(line(), "uef", int(first) - 1, int(last) + 1, 0)
        pulsed = changed(pulsed, "uef", rise, rise + LINK.rise(64), 1)
        anf = changed(pulsed, "anf", request - 9, request + skew, 0) if skew > 0 else pulsed
        anf = changed(anf, "anf", request + skew, request + 9, 1) if skew < 0 else anf
        assert list(read(anf))[1].causes == cause


def test_no_answer_is_due_while_the_line_is_high() -> None:
    rises = line()["uef"].rising().tolist()
    high = changed(line(), "uef", rises[1] + 1, rises[3] - 100, 1)
    assert [answer.causes for answer in read(high, False)] == [
        *(Cause(0), Cause.LONG, Cause(0), Cause(0))
    ]


def test_a_missing_answer_is_told_with_the_tick_in_which_it_was_due() -> None:
    rises = line()["uef"].rising().tolist()
    silent = changed(line(), "uef", rises[1] - 10, rises[3] - 10, 0)
    by_request = list(read(silent))
    assert [answer.causes for answer in by_request] == [
        *(Cause(0), Cause.TIMEOUT, Cause.TIMEOUT, Cause(0), Cause(0))
    ]
    alone = list(read(silent, requests=False))
    assert [answer.tick for answer in alone] == rises
    assert [answer.causes for answer in alone] == [answer.causes for answer in by_request]
    assert alone[1] == model.Answer(rises[1], None, None, 0, None, Cause.TIMEOUT)
    assert [answer.tick for answer in read(line().extend(rises[-1] + 1_300_000), False)] == [
        *(*rises, rises[-1] + 800_000)
    ]


def test_without_a_clock_an_answer_is_short_and_nothing_else() -> None:
    rises = line()["uef"].rising().tolist()
    stopped = changed(line(), "clk", rises[1] + 1000, rises[2] - 5000, 0)
    for requests in (True, False):
        reading = read(stopped, requests)
        assert [answer.causes for answer in reading] == [
            *(Cause(0), Cause.SHORT, Cause(0), Cause(0), Cause(0))
        ]
        assert reading.clock_stops == 1
        assert reading.bit_rate_hz == pytest.approx(512_000, rel=1e-5)
    dead = changed(line(), "clk", 1, line().end - 1, 0)
    reading = read(dead)
    assert reading.bit_rate_hz is None
    assert [answer.causes for answer in reading] == [Cause.SHORT] * 4


def test_each_pulse_has_its_causes_without_requests() -> None:
    falls = line()["uef"].falling().tolist()
    long = changed(line(), "uef", falls[0], falls[0] + 200, 1)
    assert [a.causes for a in read(long, False)][:2] == [Cause.LONG, Cause(0)]
    assert [a.bits for a in read(long, False)][:2] == [67, 64]
    assert next(iter(read(long, False))).word is None
    early = changed(line(), "uef", falls[0] - 200, falls[0], 0)
    assert [a.causes for a in read(early, False)][:2] == [Cause.SHORT, Cause(0)]
    edge = LINK.fall(12 + 1) + 1
    shaken = changed(line(), "data", edge, edge + 2, 1)
    assert [a.causes for a in read(shaken, False)][:2] == [Cause.UNSTABLE, Cause(0)]
    assert not read(shaken, False, filter_ticks=2).causes.any()
    strict = replace(LINK, zero_is_fault=True, fault_word=42)
    assert [a.causes for a in read(line(), False, strict)] == [
        *(Cause(0), Cause.ZERO_WORD, Cause(0), Cause(0), Cause.FAULT_WORD)
    ]


def test_a_line_that_stays_high_is_long_even_before_it_falls() -> None:
    rise = int(line()["uef"].rising()[-1])
    stuck = changed(line(), "uef", rise, line().end - 1, 1).slice(0, line().end - 2)
    last = list(read(stuck, False))[-1]
    assert (last.rise, last.fall, last.word, last.causes) == (rise, None, None, Cause.LONG)


def test_nothing_captured_is_nothing_read() -> None:
    low = Waveform.of([5], [0])
    for anf in (None, low):
        reading = read_line(low, low, low, LINK, Fraction(1, 1000), (5, 100), anf)
        assert (len(reading), list(reading), reading.bit_rate_hz) == (0, [], None)
    with pytest.raises(ValueError, match="filter_ticks must be between 0 and 65535, not -1"):
        read_line(low, low, low, LINK, Fraction(1, 1000), (5, 100), None, -1)


def test_wide_words_are_whole_numbers() -> None:
    config = short(9, word_bits=80, timeout_bits=3, filter_ticks=1, guard_ticks=1)
    levels, word = quiet(config, 2), 0x1234_5678_9ABC_DEF0_1357
    draw_answer(config, levels, 0, Answer(1, word))
    pins = trace(config, levels).select(["uef", "data"])
    capture = pins.merge(Model(config).advance(pins.end, pins, ["clk", "anf"]))
    assert [answer.word for answer in read(capture, True, config)] == [word, None]
