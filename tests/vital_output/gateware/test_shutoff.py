"""The test of the shut-off paths: its turns, by the contract's paragraph on it (DRV-18)."""

from __future__ import annotations

from functools import cache
from itertools import product
from random import Random

import pytest

from railgate.vital_output.gateware.shutoff import Shutoff
from railgate.vital_output.spec import State, TestPhase
from vital_output.gateware.bench import Bench, high, values
from vital_output.small import SMALL

pytestmark = pytest.mark.shows("DRV-18")

WANTED, RUNNING, DONE, REQUESTED = TestPhase
INPUTS = ("states", "image", "peer_ok", "peer_test", "booted", "test")
QUIET = (State.IDLE, State.HANDSHAKE_ALARM, State.FEEDBACK_ALARM)
BOARDS = pytest.mark.parametrize("board", [0, 1])
PEER = {"peer_ok": 1, "peer_test": DONE}
READY = {0: PEER | {"peer_test": WANTED}, 1: PEER}
"""The peer as it is when this board's turn has come."""


@cache
def bench(board):
    return Bench(Shutoff(SMALL, board))


def states(*each):
    """The outputs' states, that of output 0 first."""
    return {"states": sum(state << 3 * output for output, state in enumerate(each))}


def run(board, steps, end=40):
    """From each of these ticks on the inputs told are as told, the others 0."""
    given = {
        name: {tick: int(inputs.get(name, 0)) for tick, inputs in steps.items()} for name in INPUTS
    }
    return bench(board).run(end, given)


def phases(result):
    """The phases by their first ticks."""
    wave = result["test_phase"]
    return dict(zip(wave.ticks.tolist(), map(TestPhase, wave.values.tolist()), strict=True))


def done(board, steps):
    """The steps, after a test that is done in tick 8."""
    before = {0: {}, 5: READY[board], 6: PEER | states(State.TEST, State.TEST), 7: PEER}
    return before | steps


@BOARDS
def test_at_start_it_is_wanted_and_begins_in_its_turn(board):
    steps = {0: {}, 5: READY[board], 6: PEER | states(State.TEST, State.IDLE)}
    result = run(board, steps)
    assert phases(result) == {0: WANTED, 6: RUNNING}
    assert high(result, "begins") == [5]


@BOARDS
@pytest.mark.parametrize("state", State)
def test_it_begins_only_when_all_outputs_are_quiet(board, state):
    for each in ((state, State.IDLE), (State.IDLE, state)):
        begins = high(run(board, {0: READY[board] | states(*each)}), "begins")
        assert begins == ([0] if state in QUIET else [])


@BOARDS
def test_it_begins_only_with_a_peer_in_the_right_phase(board):
    right = (WANTED,) if board == 0 else (DONE, REQUESTED)
    for peer, ok in product(TestPhase, (0, 1)):
        begins = high(run(board, {0: {"peer_ok": ok, "peer_test": peer}}), "begins")
        assert begins == ([0] if ok and peer in right else [])


@BOARDS
@pytest.mark.parametrize("state", State)
def test_it_runs_until_no_output_is_tested_or_waits(board, state):
    steps = {0: READY[board], 1: PEER | states(State.IDLE, state), 20: PEER}
    busy = state in (State.TEST, State.WAIT)
    assert phases(run(board, steps)) == {0: WANTED, 1: RUNNING, (21 if busy else 2): DONE}


def test_when_all_outputs_are_in_alarm_it_is_done_at_once():
    alarms = states(State.HANDSHAKE_ALARM, State.FEEDBACK_ALARM)
    assert phases(run(0, {0: READY[0] | alarms})) == {0: WANTED, 1: RUNNING, 2: DONE}


@BOARDS
def test_a_peer_that_starts_anew_makes_a_test_wanted_in_its_leader(board):
    found = phases(run(board, done(board, {10: PEER | {"booted": 1}, 11: PEER})))
    assert found == {0: WANTED, 6: RUNNING, 8: DONE} | ({11: WANTED} if board == 0 else {})


@pytest.mark.parametrize("peer", TestPhase)
def test_fpga_2_follows_a_leader_that_wants_or_makes_its_test(peer):
    follows = peer in (WANTED, RUNNING)
    for ok in (0, 1):
        steps = done(1, {8: PEER, 10: {"peer_ok": ok, "peer_test": peer}})
        found = phases(run(1, steps, 12))
        assert found == {0: WANTED, 6: RUNNING, 8: DONE} | ({11: WANTED} if follows and ok else {})


@BOARDS
def test_the_input_requests_a_test_once_the_first_is_done(board):
    resting = PEER | states(State.DRIVE, State.IDLE)
    steps = done(board, {6: PEER | {"test": 1}, 7: PEER, 8: resting, 20: resting | {"test": 1}})
    assert phases(run(board, steps)) == {0: WANTED, 6: RUNNING, 7: DONE, 21: REQUESTED}


def test_a_request_is_granted_by_the_leader_when_outputs_and_image_are_quiet():
    driving = PEER | {"peer_test": DONE, "image": 0b10} | states(State.DRIVE, State.IDLE)
    steps = {10: driving | {"test": 1}, 11: driving, 15: driving | states(0, 0)}
    steps |= {20: driving | {"image": 0}, 25: PEER}
    found = phases(run(0, done(0, {8: driving} | steps)))
    assert found == {0: WANTED, 6: RUNNING, 8: DONE, 11: REQUESTED, 26: WANTED}
    resting = PEER
    found = phases(run(1, done(1, {8: resting, 10: resting | {"test": 1}, 11: resting})))
    assert found == {0: WANTED, 6: RUNNING, 8: DONE, 11: REQUESTED}


@BOARDS
@pytest.mark.parametrize("ok", [0, 1])
def test_the_leader_takes_a_request_of_its_peer(board, ok):
    resting = {"peer_test": DONE} | states(State.DRIVE, State.IDLE)
    steps = {8: resting, 10: {"peer_ok": ok, "peer_test": REQUESTED, "image": 1}}
    found = phases(run(board, done(board, steps), 12))
    asked = {11: REQUESTED} if board == 0 and ok else {}
    assert found == {0: WANTED, 6: RUNNING, 8: DONE} | asked


@BOARDS
def test_the_peer_is_watched_while_it_pulses_alone(board):
    for peer, ok in product(TestPhase, (0, 1)):
        result = run(board, {0: {"peer_ok": ok, "peer_test": peer} | states(State.WAIT, 0)}, 3)
        assert values(result, "watching") == [int(ok and peer is RUNNING)] * 3


@BOARDS
def test_outputs_may_drive_when_both_fpgas_have_done_their_test(board):
    for peer in TestPhase:
        steps = done(board, {8: {"peer_test": peer}, 10: {"peer_test": peer, "test": 1}})
        result = run(board, steps, 12)
        mine = [phase in (DONE, REQUESTED) for phase in values(result, "test_phase")]
        both = [int(here and peer in (DONE, REQUESTED)) for here in mine]
        assert values(result, "both_done")[8:] == both[8:]
        assert mine[8:] == [True] * 4


def expected(board, ticks):
    """The phase in each tick, sentence by sentence."""
    phase, told = WANTED, []
    for seen in ticks:
        told.append(phase)
        each = [State(seen["states"] >> 3 * output & 7) for output in range(SMALL.outputs)]
        quiet = all(state in QUIET for state in each)
        peer, ok = seen["peer_test"], seen["peer_ok"]
        is_done = phase in (DONE, REQUESTED)
        if board == 0:
            turn, anew = peer == WANTED, seen["booted"]
            granted, asked = quiet and not seen["image"], ok and peer == REQUESTED
        else:
            turn, anew = peer in (DONE, REQUESTED), ok and peer in (WANTED, RUNNING)
            granted = asked = False
        if phase is WANTED and quiet and ok and turn:
            phase = RUNNING
        elif phase is RUNNING and not {State.TEST, State.WAIT} & set(each):
            phase = DONE
        elif (is_done and anew) or (phase is REQUESTED and granted):
            phase = WANTED
        elif phase is DONE and (seen["test"] or asked):
            phase = REQUESTED
    return told


@BOARDS
def test_random_surroundings_bring_the_phases_of_the_contract(board):
    random = Random(board)
    ticks = [
        {
            **states(*(random.choice([*QUIET, *State]) for _ in range(SMALL.outputs))),
            "image": random.choice([0, 0, 0b10]),
            "peer_ok": random.randrange(2),
            "peer_test": random.choice([*TestPhase]),
            "booted": int(random.random() < 0.1),
            "test": int(random.random() < 0.3),
        }
        for _ in range(10_000)
    ]
    result = run(board, dict(enumerate(ticks)), len(ticks))
    assert values(result, "test_phase") == expected(board, ticks)


@BOARDS
def test_an_upset_phase_is_told_and_the_test_is_wanted_anew(board):
    shutoff = bench(board)
    legal = set()
    for code in range(1 << 6):
        run(board, done(board, {}), 20)
        given = {name: {0: READY[board].get(name, 0)} for name in INPUTS}
        shutoff.engine.poke("held_phase.code", code)
        result = shutoff.go_on(30, given)
        if high(result, "error"):
            assert high(result, "error") == [20]
            assert values(result, "test_phase")[:3] == [WANTED, WANTED, RUNNING]
            assert high(result, "begins") == [21]
        else:
            legal.add(code)
    assert len(legal) == len(TestPhase)
