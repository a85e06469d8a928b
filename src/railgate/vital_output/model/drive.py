"""The outputs' state machines and the test of the shut-off paths (DRV-8 … DRV-12, DRV-18)."""

from __future__ import annotations

from typing import Any

from numba import njit

from railgate.vital_output.model.link import peer_ok
from railgate.vital_output.model.pins import alive, head, pop, turn
from railgate.vital_output.model.records import FAR
from railgate.vital_output.model.trains import begin_train, end_train
from railgate.vital_output.spec import Code, State, TestPhase

__all__ = ["drive", "test"]

IDLE, PRE_DRIVE, DRIVE = int(State.IDLE), int(State.PRE_DRIVE), int(State.DRIVE)
WAIT, TEST = int(State.WAIT), int(State.TEST)
HANDSHAKE_ALARM, FEEDBACK_ALARM = int(State.HANDSHAKE_ALARM), int(State.FEEDBACK_ALARM)

OFF, PEER_PRE_DRIVE = int(Code.OFF), int(Code.PRE_DRIVE)
PEER_DRIVE, PEER_ALARM = int(Code.DRIVE), int(Code.ALARM)

WANTED, RUNNING = int(TestPhase.WANTED), int(TestPhase.RUNNING)
DONE, REQUESTED = int(TestPhase.DONE), int(TestPhase.REQUESTED)

SETTLED = 3
"""Ticks from reset until a pin's first level is there."""


@njit(nogil=True)
def quiet(limit: Any, c: Any) -> bool:
    """Whether each output is IDLE or in an alarm."""
    for i in range(limit.outputs):
        state = c.outputs[i].state
        if state not in (IDLE, HANDSHAKE_ALARM, FEEDBACK_ALARM):
            return False
    return True


@njit(nogil=True)
def tested(limit: Any, c: Any) -> bool:
    """Whether no output is TEST or WAIT any more."""
    busy = 0
    for i in range(limit.outputs):
        busy += c.outputs[i].state in (TEST, WAIT)
    return busy == 0


@njit(nogil=True)
def test(limit: Any, c: Any, asked: bool, booted: bool) -> bool:
    """The phase of the test; whether it begins."""
    was, r = c.was, c.now
    phase, peer, ok, leads = was.test_phase, was.peer.test, peer_ok(was), c.board == 0
    done, peer_done = phase >= DONE, peer >= DONE
    ready = peer == WANTED if leads else peer_done
    if phase == WANTED and ok and ready and quiet(limit, c):
        r.test_phase = RUNNING
        return True
    if phase == RUNNING and tested(limit, c):
        r.test_phase = DONE
    elif (
        (leads and done and booted)
        or (not leads and done and ok and peer in (WANTED, RUNNING))
        or (leads and phase == REQUESTED and was.image == 0 and quiet(limit, c))
    ):
        r.test_phase = WANTED
    elif phase == DONE and (asked or (leads and ok and peer == REQUESTED)):
        r.test_phase = REQUESTED
    return False


@njit(nogil=True)
def follow(
    limit: Any,
    o: Any,
    elapsed: int,
    cmd: bool,
    fb: bool,
    frequency: bool,
    contact: bool,
    code: int,
    watching: bool,
    begins: bool,
    acknowledged: bool,
) -> int:
    """The state of an output in the next tick."""
    state = o.state
    if state == IDLE:
        if fb:
            return FEEDBACK_ALARM if watching else WAIT
        return TEST if begins else PRE_DRIVE if cmd else IDLE
    if state == PRE_DRIVE:
        if not cmd:
            return IDLE
        if fb:
            return WAIT
        if code in (PEER_PRE_DRIVE, PEER_DRIVE):
            return DRIVE
        return HANDSHAKE_ALARM if elapsed >= limit.tau1_ticks - 1 else PRE_DRIVE
    if state == DRIVE:
        if not cmd:
            return WAIT
        if code == PEER_ALARM:
            return HANDSHAKE_ALARM
        if code == OFF:
            return WAIT
        if code == PEER_PRE_DRIVE and elapsed >= limit.not_yet_driving_ticks:
            return HANDSHAKE_ALARM
        if elapsed >= limit.pulse_grace_ticks and not frequency:
            return FEEDBACK_ALARM
        return FEEDBACK_ALARM if elapsed >= limit.pick_up_ticks and not contact else DRIVE
    if state == WAIT:
        if o.left and cmd and elapsed >= limit.skew_ticks:
            return HANDSHAKE_ALARM
        if not fb and not (o.left and cmd):
            return IDLE
        return FEEDBACK_ALARM if fb and elapsed >= limit.release_ticks else WAIT
    if state == TEST:
        if contact:
            return FEEDBACK_ALARM
        if elapsed >= limit.test_ticks - 1:
            return WAIT if frequency else FEEDBACK_ALARM
        return TEST
    if cmd or fb or (state == FEEDBACK_ALARM and not acknowledged):
        return state
    return IDLE


@njit(nogil=True)
def wake(limit: Any, c: Any, i: int, tick: int) -> int:
    """The next tick in which an output may leave its state, if nothing but its pins changes."""
    o, feedback = c.outputs[i], c.feedback_pins[i]
    due = min(head(c.contact_pins[i]), c.origin + SETTLED)
    due = due if due > tick else head(c.contact_pins[i])
    since = tick - o.entered
    first = second = third = -1
    if o.state == PRE_DRIVE:
        first = limit.tau1_ticks - 1
    elif o.state == DRIVE:
        first, second = limit.not_yet_driving_ticks, limit.pulse_grace_ticks
        third = limit.pick_up_ticks
    elif o.state == WAIT:
        first, second = limit.skew_ticks, limit.release_ticks
    elif o.state == TEST:
        first = limit.test_ticks - 1
    for limit_ticks in (first, second, third):
        due = min(due, o.entered + limit_ticks) if limit_ticks > since else due
    if o.steady:
        return due
    due = min(due, head(feedback))
    for later in (limit.period_high_ticks + 1, limit.zero_ticks):
        due = min(due, feedback.rise + later) if feedback.rise + later > tick else due
    return due


@njit(nogil=True)
def enter(limit: Any, c: Any, i: int, state: int, left: bool, tick: int) -> None:
    """An output is in another state from this tick on; a steady train that ends has `ceased`."""
    o = c.outputs[i]
    drove, drives = o.state in (DRIVE, TEST), state in (DRIVE, TEST)
    o.left = left and state == WAIT and o.state == DRIVE
    o.state, o.entered = state, tick
    if drives:
        begin_train(o, tick)
    elif drove:
        end_train(limit, o, tick)
        c.ceased |= (1 << i) if o.steady else 0
    if c.drawn:
        c.toggle = min(c.toggle, o.toggle)


@njit(nogil=True)
def sense(limit: Any, c: Any, i: int, tick: int) -> tuple[bool, bool, bool]:
    """fb, frequency and contact of an output in this tick."""
    o, pin, contact_pin = c.outputs[i], c.feedback_pins[i], c.contact_pins[i]
    if head(contact_pin) == tick:
        pop(contact_pin)
    contact = contact_pin.level == 1 and tick >= c.origin + SETTLED
    if o.steady:
        return True, True, contact
    fb = contact or tick - pin.rise < limit.zero_ticks
    return fb, alive(pin, tick, limit.period_high_ticks), contact


@njit(nogil=True)
def drive(limit: Any, c: Any, tick: int, begins: bool, acknowledged: int) -> tuple[bool, int, int]:
    """All outputs: whether a state changes, and which of them enter an alarm of either kind."""
    was, due, moved, handshake, feedback = c.was, FAR, False, 0, 0
    ok = peer_ok(was)
    commands = was.image & ~was.blocked if was.test_phase >= DONE and was.peer.test >= DONE else 0
    watching = ok and was.peer.test == RUNNING
    for i in range(limit.outputs):
        o, pin = c.outputs[i], c.feedback_pins[i]
        fb, frequency, contact = sense(limit, c, i, tick)
        cmd, acked = commands >> i & 1 == 1, acknowledged >> i & 1 == 1
        code = (was.peer.low >> i & 1) + 2 * (was.peer.high >> i & 1) if ok else OFF
        elapsed = tick - o.entered
        state = follow(
            limit, o, elapsed, cmd, fb, frequency, contact, code, watching, begins, acked
        )
        if not o.steady and head(pin) == tick:
            turn(pin, tick, limit.period_low_ticks, limit.period_high_ticks)
            due = tick + 1
        o.left &= cmd
        if state != o.state:
            moved = True
            handshake |= (1 << i) if state == HANDSHAKE_ALARM else 0
            feedback |= (1 << i) if state == FEEDBACK_ALARM else 0
            enter(limit, c, i, state, cmd, tick + 1)
        due = min(due, wake(limit, c, i, tick))
    c.drive_due = due
    return moved, handshake, feedback
