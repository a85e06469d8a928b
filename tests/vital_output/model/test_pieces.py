"""The model of a channel is the same in whatever pieces it is run, and leaps over nothing."""

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from railgate.vital_output.model import ChannelModel
from railgate.waves import Trace, Waveform
from vital_output.equality import assert_same
from vital_output.model.bench import Bench
from vital_output.random_channel import surroundings
from vital_output.small import SMALL

random = settings(max_examples=12, deadline=None, suppress_health_check=[HealthCheck.too_slow])
CYCLES = 4
END = CYCLES * SMALL.cycle_ticks
CUTS = st.lists(st.integers(0, END), max_size=12)
SEEDS = st.integers(0, 1 << 32)
BOARDS = st.integers(0, 1)


def surrounded(board: int, seed: int) -> Trace:
    return surroundings(SMALL, board, CYCLES, seed, ChannelModel(SMALL, board))


def pieces(model: ChannelModel, stimulus: Trace, cuts: Sequence[int]) -> Trace:
    """The outputs from now on, run in pieces that end at `cuts`."""
    ends = [*sorted(cut for cut in cuts if model.now <= cut <= stimulus.end), stimulus.end]
    parts = [model.advance(end, stimulus) for end in ends]
    return parts[0].concatenate(*parts[1:])


@random
@given(BOARDS, SEEDS, CUTS)
def test_pieces_equal_the_whole(board: int, seed: int, cuts: list[int]) -> None:
    stimulus = surrounded(board, seed)
    whole = ChannelModel(SMALL, board).advance(stimulus.end, stimulus)
    assert_same(pieces(ChannelModel(SMALL, board), stimulus, cuts), whole, board, seed)
    for wave in whole.signals.values():  # that it holds what a waveform must
        assert Waveform(wave.ticks, wave.values, wave.width) == wave


@random
@given(BOARDS, SEEDS, st.integers(0, END - 150))
def test_tick_by_tick_equals_the_whole(board: int, seed: int, first: int) -> None:
    """In a piece of one tick nothing is leapt over."""
    stimulus = surrounded(board, seed)
    whole = ChannelModel(SMALL, board).advance(stimulus.end, stimulus)
    cuts = range(first, first + 150)
    assert_same(pieces(ChannelModel(SMALL, board), stimulus, cuts), whole, board, seed)


@random
@given(BOARDS, SEEDS, CUTS, st.integers(0, END))
def test_a_restored_checkpoint_goes_on_as_before(
    board: int, seed: int, cuts: list[int], at: int
) -> None:
    stimulus = surrounded(board, seed)
    model = ChannelModel(SMALL, board)
    pieces(model, stimulus.slice(0, at), cuts)
    saved = model.checkpoint()
    once = model.advance(stimulus.end, stimulus)
    for engine in (model, ChannelModel(SMALL, board)):
        engine.restore(saved)
        assert engine.now == at
        assert_same(pieces(engine, stimulus, cuts), once, board, seed)


@random
@given(BOARDS, SEEDS, CUTS, st.data())
def test_what_is_asked_for_is_what_all_would_be(
    board: int, seed: int, cuts: list[int], data: st.DataObject
) -> None:
    stimulus = surrounded(board, seed)
    whole = ChannelModel(SMALL, board).advance(stimulus.end, stimulus)
    model = ChannelModel(SMALL, board)
    for end in sorted([*cuts, stimulus.end]):
        start = model.now
        names = data.draw(st.sets(st.sampled_from(list(whole.signals)), max_size=5))
        some = model.advance(end, stimulus, names)
        assert list(some.signals) == [name for name in whole.signals if name in names]
        if end > start:
            assert_same(some, whole.slice(start, end).select(some.signals), board, seed, start)


def test_inputs_left_out_keep_what_they_held() -> None:
    bench = Bench()
    bench.trust(5, 1_000)
    bench.frame(1_000, 5, sequence=1)
    whole = bench.run(3_000)
    model = ChannelModel(SMALL, 0)
    stimulus = bench.stimulus(3_000)
    first = model.advance(1_005, stimulus)  # in the middle of the frame
    only = stimulus.select(["command.payload", "command.valid"])
    assert_same(first.concatenate(model.advance(3_000, only)), whole)


def test_time_alone_costs_nothing_but_cycles() -> None:
    model = ChannelModel(SMALL, 0)
    end = 20_000 * SMALL.cycle_ticks
    run = model.advance(end, Bench().stimulus(end), ["index"])
    assert np.array_equal(run["index"].ticks, SMALL.cycle_ticks * np.arange(20_000))


def test_what_does_not_fit_is_an_error() -> None:
    model = ChannelModel(SMALL, 0)
    stimulus = Bench().stimulus(100)
    with pytest.raises(
        ValueError, match=r'no output "x" in vital output; there are: command\.ready'
    ):
        model.advance(10, stimulus, ["x"])
    with pytest.raises(ValueError, match='no input "clk" in vital output'):
        model.advance(10, stimulus.rename({"link_rx": "clk"}))
    with pytest.raises(ValueError, match="no register"):
        model.poke("life", 0)
    with pytest.raises(ValueError, match="a checkpoint must be of"):
        model.restore(ChannelModel(SMALL, 1).checkpoint())
    assert model.now == 0
    assert model.registers == ()
