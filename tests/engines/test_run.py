"""A stimulus is run to its end in exact steps, with progress."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

from railgate.engines.run import run
from railgate.odometer.model import Model
from railgate.odometer.spec import Config
from railgate.waves import Trace, Waveform

CONFIG = Config(sensors=1)


def strobes(start: int, end: int) -> Trace:
    ticks = [start, *(tick + high for tick in range(start + 40, end, 97) for high in (0, 1))]
    wave = Waveform.of(ticks, [i % 2 for i in range(len(ticks))])
    return Trace({"strobe": wave}, Fraction(1, CONFIG.clock_hz), start, end)


def test_progress_rises_to_1_and_the_pieces_are_the_whole() -> None:
    stimulus, told = strobes(0, 12_345), list[float]()
    pieces = run(Model(CONFIG), stimulus, told.append)
    assert pieces == run(Model(CONFIG), stimulus)
    assert len(told) == 100
    assert told[-1] == 1
    assert all(0 < before < after for before, after in pairwise(told))


def test_ticks_that_no_float_holds_are_run_to_the_last() -> None:
    begin, end = (1 << 60) + 1, (1 << 60) + 12_346
    stimulus, ends = strobes(0, 100).extend(begin), list[int]()
    engine = Model(CONFIG)
    engine.advance(begin, stimulus)
    result = run(engine, strobes(begin, end), lambda _part: ends.append(engine.now))
    assert (result.start, result.end, engine.now) == (begin, end, end)
    assert ends == [begin + 12_345 * i // 100 for i in range(1, 101)]


def test_nothing_to_run_is_an_empty_result() -> None:
    engine, told = Model(CONFIG), list[float]()
    run(engine, strobes(0, 500))
    result = run(engine, strobes(0, 500), told.append)
    assert (result.start, result.end, told) == (500, 500, [1])


def test_a_run_shorter_than_its_parts_is_run_once_in_each_tick() -> None:
    told = list[float]()
    assert run(Model(CONFIG), strobes(0, 4), told.append) == run(Model(CONFIG), strobes(0, 4))
    assert told == [0.25, 0.5, 0.75, 1]
