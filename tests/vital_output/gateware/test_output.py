"""One output: its transitions (DRV-8 … DRV-12) in their order, limits to the tick, its train."""

from __future__ import annotations

from functools import cache

import pytest

from railgate.vital_output.gateware.output import Output
from railgate.vital_output.spec import Code, State
from vital_output.gateware.bench import Bench, high, values
from vital_output.small import SMALL

IDLE, PRE_DRIVE, DRIVE, WAIT, TEST, HANDSHAKE_ALARM, FEEDBACK_ALARM = State
FLAGS = ("cmd", "fb", "frequency", "contact", "begins", "watching", "acknowledged", "upset")
INPUTS = (*FLAGS, "peer_code")
PERIOD, HALF = SMALL.period_ticks, SMALL.half_period_ticks
DRIVEN = {"cmd": 1, "fb": 1, "frequency": 1, "contact": 1, "peer_code": Code.DRIVE}
"""What an output sees that drives its relay."""
EVERYTHING = dict.fromkeys(FLAGS[:-1], 1)
LEFT = "left"
"""In WAIT, since the peer has left DRIVE first."""


@cache
def bench():
    return Bench(Output(SMALL))


def run(steps, end):
    """From each of these ticks on the inputs told are as told, the others 0."""
    given = {
        name: {tick: int(inputs.get(name, 0)) for tick, inputs in steps.items()} for name in INPUTS
    }
    return bench().run(end, given)


def states(result):
    """The states by their first ticks."""
    wave = result["state"]
    return dict(zip(wave.ticks.tolist(), map(State, wave.values.tolist()), strict=True))


WAYS = {
    IDLE: (0, {0: {}}),
    PRE_DRIVE: (11, {10: {"cmd": 1}}),
    DRIVE: (12, {10: {"cmd": 1}, 11: {"cmd": 1, "peer_code": Code.PRE_DRIVE}, 12: DRIVEN}),
    WAIT: (11, {10: {"fb": 1}}),
    LEFT: (
        21,
        {
            10: {"cmd": 1, "peer_code": Code.DRIVE},
            12: DRIVEN,
            20: DRIVEN | {"peer_code": Code.OFF},
            21: {"cmd": 1},
        },
    ),
    TEST: (11, {10: {"begins": 1}, 11: {}}),
    HANDSHAKE_ALARM: (
        21,
        {10: {"cmd": 1, "peer_code": Code.DRIVE}, 20: DRIVEN | {"peer_code": Code.ALARM}},
    ),
    FEEDBACK_ALARM: (11, {10: {"watching": 1, "fb": 1}, 11: {}}),
}
"""How an output comes into each state: the state's first tick, and the inputs until then, with
which it stays."""


def after(state, elapsed, inputs):
    """What follows if in the tick of this state with this `elapsed` the inputs are these."""
    entry, way = WAYS[state]
    tick = entry + elapsed
    steps = {step: held for step, held in way.items() if step < tick}
    found = values(run(steps | {tick: inputs}, tick + 2), "state")
    assert found[tick] == (WAIT if state is LEFT else state)
    return State(found[tick + 1])


def at_limit(state, limit, before, reached, **inputs):
    """Two rows of the table: what follows with the same inputs a tick before a limit, and at it."""
    return [(state, limit - 1, inputs, before), (state, limit, inputs, reached)]


PEER_DRIVES = {"peer_code": Code.DRIVE}
PEER_PREPARES = {"peer_code": Code.PRE_DRIVE}
NO_FREQUENCY = DRIVEN | {"frequency": 0}
NO_CONTACT = DRIVEN | {"contact": 0}
NOT_YET = DRIVEN | PEER_PREPARES
C = SMALL
TABLE = [
    (IDLE, 5, EVERYTHING, FEEDBACK_ALARM),
    (IDLE, 5, EVERYTHING | {"watching": 0}, WAIT),
    (IDLE, 5, EVERYTHING | {"fb": 0}, TEST),
    (IDLE, 5, EVERYTHING | {"fb": 0, "begins": 0}, PRE_DRIVE),
    (IDLE, 5, EVERYTHING | {"fb": 0, "begins": 0, "cmd": 0} | PEER_DRIVES, IDLE),
    (PRE_DRIVE, C.tau1_ticks - 1, EVERYTHING | {"cmd": 0} | PEER_DRIVES, IDLE),
    (PRE_DRIVE, C.tau1_ticks - 1, EVERYTHING | PEER_DRIVES, WAIT),
    (PRE_DRIVE, 0, {"cmd": 1} | PEER_DRIVES, DRIVE),
    (PRE_DRIVE, C.tau1_ticks - 1, {"cmd": 1} | PEER_DRIVES, DRIVE),
    (PRE_DRIVE, C.tau1_ticks - 1, EVERYTHING | {"fb": 0} | PEER_PREPARES, DRIVE),
    *at_limit(PRE_DRIVE, C.tau1_ticks - 1, PRE_DRIVE, HANDSHAKE_ALARM, cmd=1, peer_code=Code.OFF),
    *at_limit(PRE_DRIVE, C.tau1_ticks - 1, PRE_DRIVE, HANDSHAKE_ALARM, cmd=1, peer_code=Code.ALARM),
    (DRIVE, C.pick_up_ticks, {"peer_code": Code.ALARM}, WAIT),
    (DRIVE, C.pick_up_ticks, {"cmd": 1, "peer_code": Code.ALARM}, HANDSHAKE_ALARM),
    (DRIVE, C.pick_up_ticks, {"cmd": 1, "peer_code": Code.OFF}, WAIT),
    (DRIVE, 0, DRIVEN | {"peer_code": Code.ALARM}, HANDSHAKE_ALARM),
    (DRIVE, 0, DRIVEN | {"peer_code": Code.OFF}, WAIT),
    *at_limit(DRIVE, C.not_yet_driving_ticks, DRIVE, HANDSHAKE_ALARM, **NOT_YET),
    (DRIVE, C.not_yet_driving_ticks, {"cmd": 1} | PEER_PREPARES, HANDSHAKE_ALARM),
    (DRIVE, C.not_yet_driving_ticks, DRIVEN, DRIVE),
    *at_limit(DRIVE, C.pulse_grace_ticks, DRIVE, FEEDBACK_ALARM, **NO_FREQUENCY),
    *at_limit(DRIVE, C.pulse_grace_ticks, DRIVE, FEEDBACK_ALARM, **NO_FREQUENCY | PEER_PREPARES),
    *at_limit(DRIVE, C.pick_up_ticks, DRIVE, FEEDBACK_ALARM, **NO_CONTACT),
    (DRIVE, 30_000, DRIVEN | {"begins": 1, "watching": 1, "acknowledged": 1}, DRIVE),
    (WAIT, C.skew_ticks, {"cmd": 1}, IDLE),
    (WAIT, 0, {}, IDLE),
    (WAIT, 5, {"fb": 1, "contact": 1, "cmd": 1} | PEER_DRIVES, WAIT),
    *at_limit(WAIT, C.release_ticks, WAIT, FEEDBACK_ALARM, fb=1),
    *at_limit(WAIT, C.release_ticks, WAIT, FEEDBACK_ALARM, fb=1, cmd=1),
    (WAIT, C.release_ticks, {"cmd": 1}, IDLE),
    *at_limit(LEFT, C.skew_ticks, WAIT, HANDSHAKE_ALARM, cmd=1),
    *at_limit(LEFT, C.skew_ticks, WAIT, HANDSHAKE_ALARM, cmd=1, fb=1),
    (LEFT, C.skew_ticks, {"fb": 1}, WAIT),
    (LEFT, C.skew_ticks, {}, IDLE),
    (LEFT, 0, {}, IDLE),
    (TEST, C.test_ticks - 1, {"contact": 1, "frequency": 1}, FEEDBACK_ALARM),
    (TEST, 0, {"contact": 1}, FEEDBACK_ALARM),
    (TEST, 5, EVERYTHING | {"contact": 0} | PEER_DRIVES, TEST),
    *at_limit(TEST, C.test_ticks - 1, TEST, WAIT, frequency=1, fb=1),
    *at_limit(TEST, C.test_ticks - 1, TEST, FEEDBACK_ALARM, fb=1),
    (HANDSHAKE_ALARM, 5, {"cmd": 1}, HANDSHAKE_ALARM),
    (HANDSHAKE_ALARM, 5, EVERYTHING | {"cmd": 0}, HANDSHAKE_ALARM),
    (HANDSHAKE_ALARM, 0, {}, IDLE),
    (HANDSHAKE_ALARM, 5, EVERYTHING | {"cmd": 0, "fb": 0}, IDLE),
    (FEEDBACK_ALARM, 5, {}, FEEDBACK_ALARM),
    (FEEDBACK_ALARM, 5, {"acknowledged": 1, "cmd": 1}, FEEDBACK_ALARM),
    (FEEDBACK_ALARM, 5, {"acknowledged": 1, "fb": 1}, FEEDBACK_ALARM),
    (FEEDBACK_ALARM, 5, {"acknowledged": 1} | PEER_DRIVES, IDLE),
]


@pytest.mark.shows("DRV-8", "DRV-9", "DRV-10", "DRV-11", "DRV-12", "DRV-18")
@pytest.mark.parametrize(("state", "elapsed", "inputs", "expected"), TABLE)
def test_what_follows_a_state_is_the_first_that_applies(state, elapsed, inputs, expected):
    assert after(state, elapsed, inputs) is expected


@pytest.mark.shows("DRV-10")
def test_left_is_forgotten_in_a_tick_without_cmd():
    entry, way = WAYS[LEFT]
    again = way | {50: {"fb": 1}, 51: {"fb": 1, "cmd": 1}}
    quiet = again | {entry + SMALL.skew_ticks + 50: {"cmd": 1}}
    found = states(run(quiet, entry + SMALL.skew_ticks + 60))
    assert found[entry + SMALL.skew_ticks + 51] is IDLE


@pytest.mark.shows("DRV-9", "DRV-10", "DRV-11")
def test_every_state_counts_its_elapsed_anew():
    tau1 = SMALL.tau1_ticks
    steps = {10: {"cmd": 1}, 10 + tau1 - 1: {}, 20 + tau1: {"cmd": 1}}
    found = states(run(steps, 3 * tau1))
    assert found == {
        0: IDLE,
        11: PRE_DRIVE,
        10 + tau1: IDLE,
        21 + tau1: PRE_DRIVE,
        21 + 2 * tau1: HANDSHAKE_ALARM,
    }


@pytest.mark.shows("DRV-12")
def test_alarms_are_told_in_the_tick_before_they_are_entered():
    entry, way = WAYS[HANDSHAKE_ALARM]
    result = run(way, entry + 50)
    assert high(result, "handshake_alarm") == [entry - 1]
    assert not high(result, "feedback_alarm")
    entry, way = WAYS[FEEDBACK_ALARM]
    result = run(way, entry + 50)
    assert high(result, "feedback_alarm") == [entry - 1]
    assert not high(result, "handshake_alarm")


CODES = {
    IDLE: Code.OFF,
    PRE_DRIVE: Code.PRE_DRIVE,
    DRIVE: Code.DRIVE,
    WAIT: Code.OFF,
    LEFT: Code.OFF,
    TEST: Code.OFF,
    HANDSHAKE_ALARM: Code.ALARM,
    FEEDBACK_ALARM: Code.ALARM,
}


@pytest.mark.shows("DRV-9", "DRV-12")
@pytest.mark.parametrize("state", CODES)
def test_the_peer_is_told_the_states_code_from_its_first_tick_on(state):
    entry, way = WAYS[state]
    assert values(run(way, entry + 3), "code")[entry : entry + 3] == [CODES[state]] * 3


def train(start, end):
    """The ticks in which the pulse is 1, of a state that lasts from start to before end."""
    return [tick + 1 for tick in range(start, end) if (tick - start) % PERIOD < HALF]


@pytest.mark.shows("DRV-10")
@pytest.mark.parametrize("leaves", [700, 12 + PERIOD, 12 + PERIOD + 1, 12 + PERIOD + HALF, 40_033])
def test_the_train_starts_with_drive_and_ends_with_it(leaves):
    entry, way = WAYS[DRIVE]
    result = run(way | {leaves - 1: {}}, leaves + 500)
    assert states(result)[leaves] is not DRIVE
    assert high(result, "pulse") == train(entry, leaves)


@pytest.mark.shows("DRV-10")
def test_each_train_starts_anew():
    entry, way = WAYS[DRIVE]
    again = {step + 333: held for step, held in way.items()}
    result = run(way | {300: {}} | again, 700)
    assert high(result, "pulse") == train(entry, 301) + train(entry + 333, 700 - 1)


@pytest.mark.shows("DRV-18")
def test_a_test_is_a_train_too():
    entry, way = WAYS[TEST]
    result = run(way | {500: {"frequency": 1, "fb": 1}}, entry + SMALL.test_ticks + 500)
    assert high(result, "pulse") == train(entry, entry + SMALL.test_ticks)


@pytest.mark.shows("DRV-8", "DRV-9", "DRV-11", "DRV-12")
@pytest.mark.parametrize("state", [IDLE, PRE_DRIVE, WAIT, LEFT, HANDSHAKE_ALARM, FEEDBACK_ALARM])
def test_no_other_state_makes_pulses(state):
    entry, way = WAYS[state]
    pulse = high(run(way, entry + 2000), "pulse")
    assert not [tick for tick in pulse if tick > entry]


@pytest.mark.shows("DRV-16")
def test_no_pulse_is_made_while_what_all_outputs_share_is_upset():
    _, way = WAYS[DRIVE]
    result = run(way | {30: DRIVEN | {"upset": 1}, 32: DRIVEN}, 100)
    assert high(result, "pulse") == [*range(13, 31), *range(33, 100)]
