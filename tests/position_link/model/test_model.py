"""The model keeps the contract, in whatever pieces it is run."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from position_link.reference import reference, signals
from position_link.stimuli import Answer, draw_answer, quiet, short, stimuli, trace
from railgate.position_link.model import Model
from railgate.position_link.spec import CRC16, Cause, Check, Config, Edge, Health, Status
from railgate.waves import Trace, Waveform

random = settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow])
CUTS = st.lists(st.integers(0, 9000), max_size=8)


def assert_same(left: Trace, right: Trace, *case: object) -> None:
    difference = left.first_difference(right)
    assert difference is None, (str(difference), *case)


def pieces(model: Model, stimulus: Trace, cuts: list[int]) -> Trace:
    """The outputs from now on, run in pieces that end at `cuts`."""
    ends = [*sorted(cut for cut in cuts if model.now <= cut <= stimulus.end), stimulus.end]
    parts = [model.advance(end, stimulus) for end in ends]
    return parts[0].concatenate(*parts[1:])


@pytest.mark.shows("SYS-2")
@random
@given(stimuli())
def test_equals_the_contract_taken_tick_by_tick(case: tuple[Config, Trace]) -> None:
    config, stimulus = case
    outputs = Model(config).advance(stimulus.end, stimulus)
    assert_same(outputs, reference(config, stimulus), config)
    assert list(outputs.signals) == list(signals(config))
    for wave in outputs.signals.values():  # made without a check: so check them here
        made = Waveform(wave.ticks, wave.values, wave.width, wave.signed)
        assert made.values.dtype == wave.values.dtype


@random
@given(stimuli(), CUTS)
def test_pieces_equal_the_whole(case: tuple[Config, Trace], cuts: list[int]) -> None:
    config, stimulus = case
    whole = Model(config).advance(stimulus.end, stimulus)
    assert_same(pieces(Model(config), stimulus, cuts), whole, config)
    changes = stimulus["uef"].ticks.tolist()
    assert_same(pieces(Model(config), stimulus, changes), whole, config)


@random
@given(stimuli(), CUTS, st.integers(0, 9000))
def test_a_restored_checkpoint_goes_on_as_before(
    case: tuple[Config, Trace], cuts: list[int], at: int
) -> None:
    config, stimulus = case
    model, at = Model(config), min(at, stimulus.end)
    pieces(model, stimulus.slice(0, at), cuts)
    saved = model.checkpoint()
    once = model.advance(stimulus.end, stimulus)
    for engine in (model, Model(config)):
        engine.restore(saved)
        assert engine.now == at
        assert_same(pieces(engine, stimulus, cuts), once, config)


@random
@given(stimuli(), st.data())
def test_outputs_that_are_asked_for_are_those_of_all(
    case: tuple[Config, Trace], data: st.DataObject
) -> None:
    config, stimulus = case
    every = Model(config).advance(stimulus.end, stimulus)
    names = data.draw(st.sets(st.sampled_from(list(every.signals))))
    some = Model(config).advance(stimulus.end, stimulus, names)
    assert list(some.signals) == [name for name in every.signals if name in names]
    assert some == every.select(some.signals)


CONFIG = short(10, word_bits=16, timeout_bits=4, filter_ticks=2, guard_ticks=2, count_bits=8)


def run(config: Config, *answers: Answer | None) -> Trace:
    """The outputs with one answer a cycle, equal to the reference's."""
    levels = quiet(config, len(answers))
    for cycle, answer in enumerate(answers):
        if answer:
            draw_answer(config, levels, cycle, answer)
    stimulus = trace(config, levels)
    outputs = Model(config).advance(stimulus.end, stimulus)
    assert_same(outputs, reference(config, stimulus), answers)
    return outputs


def last_causes(config: Config, *answers: Answer | None) -> Cause:
    return Cause(int(run(config, *answers)["causes"].values[-1]))


GOOD = Answer(2, 0x1234)


def test_the_first_good_word_is_fresh_and_the_third_fault_in_a_row_ends_it() -> None:
    outputs = run(CONFIG, None, GOOD, None, None, None, GOOD)
    delivered = outputs["delivery"].rising()
    seen = {name: outputs[name].at(delivered).tolist() for name in ("word", "status", "health")}
    assert seen["word"] == [0xFFFF, 0x1234, 0x1234, 0x1234, 0xFFFF, 0x1234]
    assert seen["status"] == [
        *(Status.FAULT, Status.FRESH, Status.HELD, Status.HELD, Status.FAULT, Status.FRESH)
    ]
    assert seen["health"] == [
        *(Health.START, Health.OK, Health.WARNING, Health.WARNING, Health.ALARM, Health.OK)
    ]
    assert outputs["age"].at(delivered).tolist() == [63, 0, 1, 2, 3, 0]
    assert (np.diff(delivered) == CONFIG.cycle_ticks).all()


@pytest.mark.parametrize("edge", Edge)
@pytest.mark.parametrize("guard", [0, 2])
def test_every_shift_of_every_edge_of_an_answer(edge: Edge, guard: int) -> None:
    config = replace(CONFIG, sampling_edge=edge, guard_ticks=guard)
    for shift in range(-7, 8):
        run(
            config,
            *(replace(GOOD, **{name: shift}) for name in ("rise", "fall", "late", "longer")),
            replace(GOOD, clk=0, rise=shift),
            replace(GOOD, clk=1, rise=shift),
            replace(GOOD, clk=CONFIG.window_bits, rise=shift),
            replace(GOOD, clk=0, longer=CONFIG.cycle_bits - 16, rise=shift, fall=shift),
            None,
        )


@pytest.mark.parametrize(
    ("cause", "answers"),
    [
        (Cause(0), [GOOD]),
        (Cause.TIMEOUT, [None]),
        (Cause.EARLY, [replace(GOOD, clk=0)]),
        (Cause.SHORT, [replace(GOOD, longer=-1)]),
        (Cause.LONG, [replace(GOOD, longer=1)]),
        (Cause.STUCK, [None, replace(GOOD, clk=12, longer=CONFIG.cycle_bits - 20), None]),
        (Cause.TIMEOUT | Cause.UNREQUESTED, [replace(GOOD, clk=CONFIG.window_bits)]),
        (Cause.UNSTABLE, [replace(GOOD, late=5)]),
        (Cause.FAULT_WORD, [replace(GOOD, word=0xFFFF)]),
        (Cause(0), [replace(GOOD, word=0)]),
    ],
)
def test_each_fault_has_its_cause(cause: Cause, answers: list[Answer | None]) -> None:
    assert last_causes(CONFIG, *answers) == cause


def test_a_configured_zero_and_a_wrong_check_are_causes() -> None:
    checked = replace(CONFIG, check=Check(width=5, polynomial=5), zero_is_fault=True)
    assert last_causes(checked, replace(GOOD, word=0)) == Cause.ZERO_WORD
    assert last_causes(checked, replace(GOOD, word=1)) == Cause.CHECK
    wide = short(9, word_bits=80, timeout_bits=3, check=CRC16, filter_ticks=1, guard_ticks=1)
    word = 0x1234_5678_9ABC_DEF0
    outputs = run(wide, Answer(1, word << 16 | CRC16.of(word, 64)))
    assert [int(outputs[f"word.{part}"].values[-1]) for part in (0, 1)] == [
        *(word << 16 & (1 << 64) - 1 | CRC16.of(word, 64), word >> 48)
    ]


def test_only_the_first_rise_in_the_window_begins_an_answer() -> None:
    levels = quiet(CONFIG, 1)
    draw_answer(CONFIG, levels, 0, replace(GOOD, clk=1, longer=-15))
    draw_answer(CONFIG, levels, 0, replace(GOOD, clk=3))
    stimulus = trace(CONFIG, levels)
    outputs = Model(CONFIG).advance(stimulus.end, stimulus)
    assert outputs["causes"].values[-1] == Cause.SHORT | Cause.UNREQUESTED
    assert_same(outputs, reference(CONFIG, stimulus))


@pytest.mark.parametrize("ticks", [1, CONFIG.filter_ticks + 1])
def test_what_happens_after_a_decision_belongs_to_the_next(ticks: int) -> None:
    decision, delay = 1 + CONFIG.decision_ticks, CONFIG.input_delay_ticks
    for at in range(decision - delay - 2, decision + 3):
        levels = quiet(CONFIG, 2)
        for cycle in range(2):
            draw_answer(CONFIG, levels, cycle, GOOD)
        levels["uef"][at : at + ticks] ^= 1
        stimulus = trace(CONFIG, levels)
        want = reference(CONFIG, stimulus)
        for cut in range(decision - 1, decision + 3):
            assert_same(pieces(Model(CONFIG), stimulus, [cut]), want, at, cut)


def test_counts_wrap_and_ages_stay_at_their_greatest() -> None:
    config = replace(CONFIG, age_bits=2, age_ticks_bits=16, count_bits=9)
    levels = quiet(config, 600)
    for cycle in (0, 399):
        draw_answer(config, levels, cycle, GOOD)
    outputs = Model(config).advance(600 * config.cycle_ticks, trace(config, levels))
    assert outputs["number"].values[-1] == 600 - 512
    assert outputs["timeout_cycles"].values[-1] == 598 - 512
    begins = 1 + config.cycle_ticks * np.arange(600)
    first = config.radio_first + config.word_bits + 2
    launched = [outputs["radio_data"].at(begins + config.rise(first + n)) for n in range(10)]
    sent = sum(bit.astype(int) << 9 - n for n, bit in enumerate(launched))
    assert (sent % 256 == np.arange(1, 601) % 256).all()
    assert np.flatnonzero(sent // 256 == 0).tolist() == [0, 399]
    assert outputs["age"].values.tolist() == [3, 0, 1, 2, 3, 0, 1, 2, 3]
    assert outputs["age_ticks"].values[-1] == (1 << 16) - 1


def test_time_alone_costs_nothing_but_cycles() -> None:
    config = Config()
    end = 50_000 * config.cycle_ticks
    idle = Trace({"uef": Waveform.of([0], [0])}, trace(config, quiet(config, 1)).period, 0, end)
    outputs = Model(config).advance(end, idle, ["number", "timeout_cycles", "delivery"])
    assert outputs["number"].values[-1] == outputs["timeout_cycles"].values[-1] == 50_000
    assert len(outputs["delivery"]) == 2 * 50_000 + 1


def test_what_does_not_fit_is_an_error() -> None:
    model = Model(CONFIG)
    stimulus = trace(CONFIG, quiet(CONFIG, 1))
    with pytest.raises(ValueError, match='no output "x" in position link; there are: clk, anf'):
        model.advance(10, stimulus, ["x"])
    with pytest.raises(ValueError, match='no input "clk" in position link'):
        model.advance(10, stimulus.rename({"uef": "clk"}))
    with pytest.raises(ValueError, match="no register"):
        model.poke("x", 0)
    with pytest.raises(ValueError, match="a checkpoint must be of"):
        model.restore(Model(replace(CONFIG, guard_ticks=1)).checkpoint())
    assert model.now == 0
    assert model.registers == ()
