"""The whole channel when one of its hardened registers is upset (DRV-16)."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import pairwise

import pytest

from railgate.vital_output.gateware import Channel
from railgate.vital_output.spec import Cause, Code, State, TestPhase
from vital_output.gateware.bench import Bench, high, values
from vital_output.small import SMALL

pytestmark = pytest.mark.shows("DRV-16")

CONFIG = replace(SMALL, error_interval_s=3 * SMALL.cycle_s)
N, ONES = CONFIG.outputs, (1 << CONFIG.outputs) - 1
PERIOD, HALF = CONFIG.period_ticks, CONFIG.half_period_ticks
CODE_BITS = 6
BEGINS = 20
"""The tick in which the test of the shut-off paths begins."""
TESTED = BEGINS + 1 + CONFIG.test_ticks
COMMANDED = TESTED + 2 * CONFIG.zero_ticks
"""The first tick with an image of ones; the outputs drive two ticks later."""
DRIVES = COMMANDED + 2
UPSET = DRIVES + 3 * PERIOD + HALF // 2
"""A tick in which the pulses are 1, after all grace."""
END = UPSET + 2 * PERIOD
WATCHED = ("pulses", "states", "image", "life", "test_phase", "first_cause", "first_output")
COUNTS = ("upset_count", "feedback_alarm_count", "handshake_alarm_count")


def train(start, end):
    """The ticks in which the pulse is 1, of a state that lasts from start to before end."""
    return [tick + 1 for tick in range(start, end) if (tick - start) % PERIOD < HALF]


def feedback():
    """What comes back of the pulses of test and drive."""
    levels = {0: 0}
    for before, tick in pairwise([0, *train(BEGINS + 1, TESTED), *train(DRIVES, END)]):
        if before + 1 != tick:
            levels |= {before + 1: 0, tick: ONES}
    return {"pulse_feedback": levels}


def poke_all(engine, registers):
    for name, value in registers.items():
        engine.poke(name, value)


def twin(name, value, width):
    """Both copies of a hardened register."""
    return {f"{name}.value_copy": value, f"{name}.inverse_copy": value ^ (1 << width) - 1}


@cache
def driving():
    """A channel in tick UPSET that has tested its shut-off paths, and drives all outputs."""
    bench = Bench(Channel(CONFIG, 0))
    engine = bench.engine
    bench.run(BEGINS, feedback())
    engine.poke("receiver.linked", 1)
    tested = bench.go_on(COMMANDED, feedback())
    assert values(tested, "test_phase")[-1] == TestPhase.DONE
    poke_all(
        engine,
        {
            "receiver.linked": 1,
            "receiver.silence": 0,
            "receiver.peer_test": TestPhase.DONE,
            "receiver.peer_codes": sum(Code.DRIVE << 2 * output for output in range(N)),
            "storage.blocked": 0,
            "status.first_link_lost": 0,
        }
        | twin("storage.held_life", CONFIG.life_cycles, 4)
        | twin("storage.held_image", ONES, N),
    )
    result = bench.go_on(UPSET, feedback(), *WATCHED)
    assert high(result, "pulses") == train(DRIVES, UPSET - 1)
    return bench, engine.checkpoint()


def upset(name, value):
    """What is seen from tick UPSET on, in which the register holds this value."""
    bench, checkpoint = driving()
    bench.engine.restore(checkpoint)
    bench.engine.poke(name, value)
    result = bench.go_on(END, feedback(), *WATCHED, *COUNTS)
    return {signal: values(result, signal) for signal in (*WATCHED, *COUNTS)}


def flips(name, value, width):
    """Each register and value that come of one flipped bit of either copy."""
    return [
        (copy, held ^ 1 << bit)
        for copy, held in twin(name, value, width).items()
        for bit in range(width)
    ]


def state_of(seen, output, tick):
    return State(seen["states"][tick - UPSET] >> 3 * output & 7)


def pulses_of(seen, output):
    return [tick for tick, level in enumerate(seen["pulses"], UPSET) if level >> output & 1]


UNDISTURBED = [tick for tick in train(DRIVES, END - 1) if tick >= UPSET]
ELAPSED_BITS = max(CONFIG.release_ticks, CONFIG.test_ticks).bit_length()


def assert_output_is_safe(seen, output):
    """From the next tick on it makes no pulses, for good; all others go on as before."""
    assert pulses_of(seen, output) == [UPSET]
    later = {state_of(seen, output, tick) for tick in range(UPSET + 1, END)}
    assert later == {State.FEEDBACK_ALARM}
    for other in set(range(N)) - {output}:
        assert pulses_of(seen, other) == UNDISTURBED
        assert {state_of(seen, other, tick) for tick in range(UPSET, END)} == {State.DRIVE}
    assert seen["image"] == [ONES] * len(seen["image"])
    assert_counted(seen, feedback_alarms=1)
    assert (seen["first_cause"][1], seen["first_output"][1]) == (Cause.FEEDBACK_ALARM, output)


def assert_all_are_safe(seen):
    """From the next tick on there is no image, no life, and nothing is driven or makes pulses."""
    for output in range(N):
        assert pulses_of(seen, output) == [UPSET]
        assert state_of(seen, output, UPSET) is State.DRIVE
        later = {state_of(seen, output, tick) for tick in range(UPSET + 1, END)}
        assert later == {State.WAIT}
    assert not any(seen["image"][1:])
    assert not any(seen["life"][1:])
    assert_counted(seen, feedback_alarms=0)
    assert (seen["first_cause"][1], seen["first_output"][1]) == (Cause.UPSET, 0)


def assert_counted(seen, feedback_alarms):
    for name, count in (("upset", 1), ("feedback_alarm", feedback_alarms), ("handshake_alarm", 0)):
        counts = seen[f"{name}_count"]
        assert counts == [0] + [count] * (len(counts) - 1), name


def test_a_channel_that_is_not_upset_drives_on():
    seen = upset("storage.blocked", 0)
    assert [pulses_of(seen, output) for output in range(N)] == [UNDISTURBED] * N
    assert not seen["upset_count"][-1]


@pytest.mark.parametrize("output", range(N))
def test_every_code_that_is_no_state_is_an_upset_and_the_output_is_in_alarm(output):
    legal = 0
    for code in range(1 << CODE_BITS):
        seen = upset(f"output_{output}.held_state.code", code)
        if seen["upset_count"][-1]:
            assert_output_is_safe(seen, output)
        else:
            legal += 1
    assert legal == len(State)


@pytest.mark.parametrize("output", range(N))
def test_each_bit_of_elapsed_is_held_twice_and_the_output_is_in_alarm(output):
    for copy, value in flips(f"output_{output}.held_elapsed", UPSET - DRIVES, ELAPSED_BITS):
        assert_output_is_safe(upset(copy, value), output)


@pytest.mark.parametrize(
    ("name", "value", "width"),
    [
        ("storage.held_life", CONFIG.life_cycles, 4),
        ("storage.held_image", ONES, N),
        ("vote.held_remaining", 0, CONFIG.tau0_ticks.bit_length()),
        ("storage.errors.held_remaining", 0, CONFIG.error_interval_cycles.bit_length()),
    ],
)
def test_each_bit_of_what_all_outputs_share_is_held_twice_and_they_all_are_safe(name, value, width):
    for copy, flipped in flips(name, value, width):
        assert_all_are_safe(upset(copy, flipped))


def test_every_code_that_is_no_phase_of_the_test_is_an_upset_and_all_outputs_are_safe():
    legal = 0
    for code in range(1 << CODE_BITS):
        seen = upset("shutoff.held_phase.code", code)
        if seen["upset_count"][-1]:
            assert_all_are_safe(seen)
            assert set(seen["test_phase"]) == {TestPhase.WANTED}
        else:
            legal += 1
    assert legal == len(TestPhase)
