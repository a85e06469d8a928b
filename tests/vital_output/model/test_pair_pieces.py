"""The closed loop in the model is the same however it is run: message by message or bit by bit,
its trains edge by edge or at rest, in whatever pieces."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from railgate.engines import Clock
from railgate.vital_output.model import PairModel
from railgate.waves import Trace, Waveform
from vital_output.equality import assert_same
from vital_output.model.random_pair import Times, clocks_of, inputs_of
from vital_output.small import SMALL

random = settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.too_slow])
SEEDS = st.integers(0, 1 << 32)
CYCLES = 14
END = CYCLES * SMALL.cycle_ticks * 10**9
CUTS = st.lists(st.integers(0, END), max_size=40)


def case(seed: int) -> tuple[tuple[Clock, ...], Trace]:
    clocks = clocks_of(SMALL, Times(), np.random.default_rng(seed))
    return clocks, inputs_of(SMALL, clocks, CYCLES, seed)


def opened(clocks: tuple[Clock, ...], seed: int) -> PairModel:
    return PairModel(SMALL, Times(), clocks, seed % 3 * 2)


def status(model: PairModel, stimulus: Trace) -> list[str]:
    """The outputs that need neither bits nor pulses."""
    names = model.advance(0, stimulus.slice(0, 0)).signals
    return [name for name in names if not name.endswith(("pulses", "link_tx"))]


def pieces(model: PairModel, stimulus: Trace, cuts: list[int], names: list[str]) -> Trace:
    ends = [*sorted(cut for cut in cuts if model.now <= cut <= stimulus.end), stimulus.end]
    parts = [model.advance(end, stimulus, names) for end in ends]
    return parts[0].concatenate(*parts[1:])


@random
@given(SEEDS, CUTS)
def test_what_rests_is_as_if_every_edge_had_been(seed: int, cuts: list[int]) -> None:
    clocks, stimulus = case(seed)
    whole = opened(clocks, seed).advance(stimulus.end, stimulus)
    model = opened(clocks, seed)
    names = status(model, stimulus)
    some = model.advance(stimulus.end, stimulus, names)
    assert_same(some, whole.select(names), seed)
    assert_same(pieces(opened(clocks, seed), stimulus, cuts, names), some, seed)
    for wave in whole.signals.values():  # that it holds what a waveform must
        assert Waveform(wave.ticks, wave.values, wave.width) == wave


@random
@given(SEEDS, CUTS, st.data())
def test_outputs_may_be_asked_for_at_any_time(
    seed: int, cuts: list[int], data: st.DataObject
) -> None:
    clocks, stimulus = case(seed)
    whole = opened(clocks, seed).advance(stimulus.end, stimulus)
    model = opened(clocks, seed)
    some = st.sampled_from(["contact", "fpga_1.pulses", "fpga_2.pulses", "fpga_1.link_tx"])
    for end in sorted([*cuts, stimulus.end]):
        start, names = model.now, data.draw(st.sets(some))
        found = model.advance(end, stimulus, names)
        if end > start:
            assert_same(found, whole.slice(start, end).select(found.signals), seed, start)


@random
@given(SEEDS, CUTS, st.integers(0, END))
def test_a_restored_checkpoint_goes_on_as_before(seed: int, cuts: list[int], at: int) -> None:
    clocks, stimulus = case(seed)
    model = opened(clocks, seed)
    names = status(model, stimulus)
    model.advance(at, stimulus, names)
    saved = model.checkpoint()
    once = model.advance(stimulus.end, stimulus, names)
    for engine in (model, opened(clocks, seed)):
        engine.restore(saved)
        assert engine.now == at
        assert_same(pieces(engine, stimulus, cuts, names), once, seed)


def test_a_checkpoint_is_of_one_loop_with_its_clocks() -> None:
    clocks, _ = case(1)
    with pytest.raises(ValueError, match="a checkpoint must be of"):
        opened(clocks, 1).restore(opened(case(2)[0], 1).checkpoint())
    with pytest.raises(ValueError, match="a checkpoint must be of"):
        opened(clocks, 1).restore(opened(clocks, 2).checkpoint())
