"""One tick of a channel: what it makes of its registers, and when it has to be looked at again."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from railgate.vital_output.model.drive import drive, test
from railgate.vital_output.model.frames import GOOD, ahead, count, take_byte, told, trusted
from railgate.vital_output.model.link import lose, next_tick, receive, take
from railgate.vital_output.model.messages import FIRST_MESSAGE, LATCH
from railgate.vital_output.model.pins import seat
from railgate.vital_output.model.records import COUNTERS, FAR, INPUTS, SIGNALS, places
from railgate.vital_output.model.vote import keep, vote
from railgate.vital_output.spec import Cause, State

__all__ = ["begin", "halt", "tick_of_channel"]

PAYLOAD, VALID = INPUTS.index("command.payload"), INPUTS.index("command.valid")
TIME_INDEX, TIME_PHASE = INPUTS.index("time.index"), INPUTS.index("time.phase")
TIME_VALID, BOOT, TEST = (INPUTS.index(name) for name in ("time.valid", "boot", "test"))

READY, LINK_TX, INDEX, TRUSTED = places("command.ready", "link_tx", "index", "trusted")
SEQUENCE, LIFE, IMAGE, ACKNOWLEDGE = places("sequence", "life", "image", "acknowledge")
STATES, BLOCKED, TEST_PHASE, LINKED = places("states.0", "blocked", "test_phase", "linked")
DRIFTING, LATCHED, FIRST_CAUSE = places("drifting", "latched", "first_cause")
FIRST_OUTPUT, COUNTS = places("first_output", "accepted_count")
CAUSES = COUNTERS.index("format") - 1

TIME_JUMP, FORWARD = int(Cause.TIME_JUMP), int(Cause.FORWARD)
HANDSHAKE_ALARM, FEEDBACK_ALARM = int(Cause.HANDSHAKE_ALARM), int(Cause.FEEDBACK_ALARM)
HIGHEST_CAUSE = int(max(Cause))
IDLE = int(State.IDLE)
STATE_BITS = 3
WORD = (1 << 32) - 1


@njit(nogil=True)
def begin(limit: Any, c: Any, domain: Any, tick: int) -> None:
    """This is a new tick 0: all as at start, and the pins' levels come through."""
    c.now = limit.blank
    c.now.zero = c.origin = c.due = c.drive_due = tick
    c.latch, c.boot = tick + FIRST_MESSAGE - LATCH, domain.held[BOOT]
    c.begun = c.twice = c.bytes = c.sends = c.settled = c.receiving = 0
    c.toggle = c.arrival = FAR
    for sender in range(2):
        s = c.senders[sender]
        s.number = s.bit = 0
        s.next = tick + FIRST_MESSAGE - 1 + s.delay
    if not c.wanted[LINK_TX]:
        c.senders[0].next = FAR
    if not c.looped:
        c.senders[1].next = FAR
    for i in range(limit.outputs):
        o = c.outputs[i]
        o.state, o.entered, o.left = IDLE, tick, 0
        o.since, o.until, o.toggle, o.regular, o.steady = FAR, FAR, FAR, 0, 0
        seat(c.feedback_pins[i])
        seat(c.contact_pins[i])
        c.feedback_pins[i].level = c.feedback_pin >> i & 1
        c.contact_pins[i].level = c.contact_pin >> i & 1
    seat(c.link)
    c.link.level = c.link_pin
    for i in range(len(COUNTERS)):
        c.counts[i] = 0


@njit(nogil=True)
def halt(limit: Any, c: Any) -> None:
    """Reset: from the next tick on all outputs are as at start, and nothing happens."""
    c.due = c.latch = c.toggle = c.senders[0].next = c.senders[1].next = FAR
    c.pulses = 0
    for signal in range(len(SIGNALS)):
        c.shown[signal] = limit.starts[signal]
    c.news = 1


@njit(nogil=True)
def keep_time(limit: Any, c: Any, domain: Any, tick: int) -> None:
    """The own time, and the network's (DRV-3)."""
    was, r, held = c.was, c.now, domain.held
    cycle, phase = limit.cycle_ticks, tick - was.zero
    correction = max(-limit.slew_ticks, min(was.pending, limit.slew_ticks))
    index, network = held[TIME_INDEX], held[TIME_PHASE]
    good = seats = False
    if held[TIME_VALID] and network < cycle:
        step = ahead(index, was.index)
        by = step * cycle + network - phase
        good = was.seated == 1 and -1 <= step <= 1 and abs(by) <= limit.margin_ticks
        later = step > 0 or (step == 0 and by >= 0)
        seats = not good and (not was.seated or (was.life == 0 and later))
        if good:
            r.pending, r.consistent = by, 1
        else:
            r.consistent = 0
            c.causes |= 0 if seats else 1 << TIME_JUMP
    if seats:
        r.seated, r.pending, r.holdover = 1, 0, 0
        last = network == cycle - 1
        r.index, r.zero = (index + last) & WORD, tick + 1 if last else tick - network
    elif phase + correction >= cycle - 1:
        r.index, r.zero = (was.index + 1) & WORD, tick + 1
        r.pending -= correction
        r.holdover = min(was.holdover + 1, limit.holdover_cycles)
    if good:
        r.holdover = 0


@njit(nogil=True)
def note(c: Any, handshake: int, feedback: int) -> None:
    """Counts the causes of this tick, and keeps the first."""
    r, lowest = c.now, 0
    for cause in range(HIGHEST_CAUSE, 0, -1):
        if c.causes >> cause & 1:
            count(c, CAUSES + cause)
            lowest = cause
    if r.first_cause == 0:
        entered = 0
        if lowest == HANDSHAKE_ALARM:
            entered = handshake
        elif lowest == FEEDBACK_ALARM:
            entered = feedback
        r.first_cause, r.first_output = lowest, 0
        while entered and not entered >> r.first_output & 1:
            r.first_output += 1


@njit(nogil=True)
def unsettled(was: Any, r: Any) -> bool:
    """Whether a register has changed that decides what happens in the next tick."""
    return (
        (was.consistent != r.consistent or was.holdover != r.holdover or was.life != r.life)
        or (was.own_there != r.own_there or was.forwarded_there != r.forwarded_there)
        or (was.open != r.open or was.own.sequence != r.own.sequence)
        or (was.linked != r.linked or was.drifting != r.drifting)
        or (was.peer.passed != r.peer.passed or was.peer.carries != r.peer.carries)
        or was.peer.frame.sequence != r.peer.frame.sequence
        or (was.peer.test != r.peer.test or was.test_phase != r.test_phase)
        or (was.peer.low != r.peer.low or was.peer.high != r.peer.high)
        or (was.image != r.image or was.blocked != r.blocked)
    )


@njit(nogil=True)
def show(limit: Any, c: Any, tick: int) -> None:
    """What the outputs are in the next tick."""
    r, shown = c.now, c.shown
    c.news = 1
    shown[READY] = tick + 1 >= r.verdict_tick
    shown[INDEX] = r.index
    shown[TRUSTED] = trusted(limit, c.was)
    shown[SEQUENCE] = r.own.sequence
    shown[LIFE] = r.life
    shown[IMAGE] = r.image
    shown[ACKNOWLEDGE] = r.acknowledge
    shown[BLOCKED] = r.blocked
    shown[TEST_PHASE] = r.test_phase
    shown[LINKED] = r.linked
    shown[DRIFTING] = r.drifting
    shown[LATCHED] = r.latched
    shown[FIRST_CAUSE] = r.first_cause
    shown[FIRST_OUTPUT] = r.first_output
    if c.counted:
        for i in range(len(COUNTERS)):
            shown[COUNTS + i] = c.counts[i] & limit.count_max
        c.counted = 0


@njit(nogil=True)
def show_states(limit: Any, c: Any) -> None:
    """Likewise of the outputs' states, 64 bits at a time."""
    word, bits, signal = np.int64(0), 0, STATES
    for i in range(limit.outputs):
        state = c.outputs[i].state
        word |= state << bits
        bits += STATE_BITS
        if bits >= 64:
            c.shown[signal] = word
            bits, signal = bits - 64, signal + 1
            word = state >> STATE_BITS - bits
    if bits:
        c.shown[signal] = word


@njit(nogil=True)
def schedule(limit: Any, c: Any, domain: Any, tick: int) -> int:
    """The next tick in which anything may change, if nothing outside does."""
    r = c.now
    correction = max(-limit.slew_ticks, min(r.pending, limit.slew_ticks))
    due = max(r.zero + limit.cycle_ticks - 1 - correction, tick + 1)
    due = min(due, next_tick(limit, c, tick))
    due = min(due, c.drive_due)
    if r.linked:
        due = min(due, r.taken + limit.lost_ticks)
    for later in (
        r.zero + limit.decision_ticks,
        r.verdict_tick - 1,
        r.verdict_tick,
        r.forward_tick,
        r.expires,
    ):
        due = min(due, later) if later > tick else due
    if domain.held[VALID]:
        due = min(due, max(tick + 1, r.verdict_tick))
    return tick + 1 if domain.held[TIME_VALID] else due


@njit(nogil=True)
def tick_of_channel(limit: Any, c: Any, domain: Any, tick: int) -> None:
    """All that happens in one tick, but for what goes out."""
    c.was = c.now
    c.causes = 0
    was, held = c.was, domain.held
    keep_time(limit, c, domain, tick)
    accepted = rejected = taken = booted = moved = False
    if tick == was.verdict_tick:
        accepted, rejected = told(limit, c)
    if held[VALID] and tick >= was.verdict_tick:
        take_byte(limit, c, held[PAYLOAD], tick)
    whole = tick == c.arrival
    if receive(limit, c, tick):
        taken, booted = take(limit, c, tick)
    c.heard = whole and taken
    lose(limit, c, tick, taken)
    forwarded = tick == was.forward_tick
    peer_accepted = forwarded and was.forward_verdict == GOOD
    c.causes |= 1 << FORWARD if forwarded and not peer_accepted else 0
    vote(limit, c, tick, accepted, peer_accepted)
    acknowledged = keep(limit, c, tick, accepted, peer_accepted, rejected, booted)
    begins = test(limit, c, held[TEST] == 1, booted)
    handshake = feedback = 0
    if tick >= c.drive_due or begins or acknowledged:
        moved, handshake, feedback = drive(limit, c, tick, begins, acknowledged)
        c.causes |= 1 << HANDSHAKE_ALARM if handshake else 0
        c.causes |= 1 << FEEDBACK_ALARM if feedback else 0
    if c.causes:
        note(c, handshake, feedback)
    if moved:
        show_states(limit, c)
    show(limit, c, tick)
    if moved or unsettled(was, c.now):
        c.drive_due = tick + 1
    c.renewed = moved or accepted or was.passed != c.now.passed
    c.renewed |= was.test_phase != c.now.test_phase
    c.due = schedule(limit, c, domain, tick)
