"""What goes from domain to domain, and from the outputs back to the pins."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from railgate.vital_output.model.clocks import sampled
from railgate.vital_output.model.link import complete_tick
from railgate.vital_output.model.messages import send
from railgate.vital_output.model.pins import head, push
from railgate.vital_output.model.records import FAR, INPUTS, NONE, SENT

__all__ = [
    "FLIP_FLOPS",
    "NO_FILTER",
    "OPEN",
    "RELAYS",
    "ROGUES",
    "STUCK",
    "complete",
    "feed",
    "go_out",
    "label",
    "passed",
    "repin",
    "wire",
]

FLIP, LOW, HIGH = INPUTS.index("flip"), INPUTS.index("low"), INPUTS.index("high")
OPEN, STUCK = INPUTS.index("open"), INPUTS.index("stuck")
CONTACT_OPEN, CONTACT_STUCK = INPUTS.index("contact_open"), INPUTS.index("contact_stuck")
ROGUES = INPUTS.index("rogue_1")

RELAYS = np.int64(2)
"""The relays' domain."""
FLIP_FLOPS, NO_FILTER = 2, np.int64(0)
"""Of the relays' synchronisers."""
SLACK = 8
"""Ticks around a message in which nothing may disturb it, beside two bits."""


@njit(nogil=True)
def label(st: Any, d: int, time: int) -> int:
    """The domain's tick in which is sampled what changes at this time."""
    domain = st.domains[d]
    if domain.frozen != NONE:
        return domain.frozen - domain.skipped
    return sampled(st.clocks[d], time) - domain.skipped


@njit(nogil=True)
def passed(st: Any, d: int, time: int) -> int:
    """The last tick that has been done, or would have been if there had been anything to do."""
    before = label(st, d, time - 1) - 1
    return max(before, st.domains[d].done)


@njit(nogil=True)
def repin(limit: Any, c: Any, domain: Any, tick: int) -> None:
    """The levels at a channel's pins from this tick on; in reset they are only kept."""
    held = domain.held
    feedback = c.feedback & ~held[OPEN] | held[STUCK]
    contact = c.contact & ~held[CONTACT_OPEN] | held[CONTACT_STUCK]
    link = 1 if held[HIGH] else 0 if held[LOW] else c.line ^ held[FLIP]
    changed = (feedback ^ c.feedback_pin) & ~c.still
    moved, turned = contact ^ c.contact_pin, link != c.link_pin
    c.feedback_pin, c.contact_pin, c.link_pin = c.feedback_pin ^ changed, contact, link
    if domain.resetting:
        return
    seen = tick + limit.input_stages
    for i in range(limit.outputs):
        if changed >> i & 1:
            push(
                c.feedback_pins[i], seen + limit.feedback_filter_ticks, limit.feedback_filter_ticks
            )
            c.drive_due = min(c.drive_due, head(c.feedback_pins[i]))
        if moved >> i & 1:
            push(c.contact_pins[i], seen + limit.contact_filter_ticks, limit.contact_filter_ticks)
            c.drive_due = min(c.drive_due, head(c.contact_pins[i]))
    if turned:
        push(c.link, seen + limit.link_filter_ticks, limit.link_filter_ticks)
        c.due = min(c.due, head(c.link))
    c.due = min(c.due, c.drive_due)


@njit(nogil=True)
def feed(st: Any, limit: Any, d: int, tick: int) -> None:
    """What a stage of the relays is fed with from a tick of theirs on, if they are not reset."""
    r, rogue = st.relays, st.domains[RELAYS].held[ROGUES + d]
    high = (tick - r.origin) % r.period < r.period // 2
    fed = st.channels[d].pulses & ~rogue | (rogue if high else 0)
    changed = (fed ^ r.fed[d]) & ~r.still[d]
    if changed and not st.domains[RELAYS].resetting:
        r.fed[d] ^= changed
        for i in range(limit.outputs):
            if changed >> i & 1:
                push(r.stages[d, i], tick + FLIP_FLOPS, NO_FILTER)
        r.due = min(r.due, tick + FLIP_FLOPS)


@njit(nogil=True)
def wire(st: Any, limit: Any, d: int, level: int, time: int) -> None:
    """The line from channel d has another level from this time on."""
    peer, domain = st.channels[1 - d], st.domains[1 - d]
    peer.line = level
    repin(limit, peer, domain, label(st, 1 - d, time))


@njit(nogil=True)
def complete(limit: Any, tick: int) -> int:
    """In which tick an undisturbed message is there whose beginning is at the pin in `tick`."""
    return complete_tick(limit, tick + limit.input_stages + limit.link_filter_ticks)


@njit(nogil=True)
def whole(st: Any, limit: Any, d: int, message: Any) -> bool:
    """Whether the message that begins now comes in undisturbed: then it does as a whole.

    Nothing may disturb it from the receiver's last edge on, since what has changed later is not
    sampled yet, until some bits behind its end, so that it has left no trace: `calm` is when
    something does.
    """
    c, peer, domain, clock = st.channels[d], st.channels[1 - d], st.domains[1 - d], st.clocks[1 - d]
    held = domain.held
    if not c.readable or domain.resetting or domain.frozen != NONE or peer.receiving:
        return False
    if peer.arrival != FAR or peer.link.count or not (peer.link.level and peer.link_pin):
        return False
    if held[FLIP] or held[LOW] or held[HIGH] or not peer.line:
        return False
    tick = label(st, 1 - d, c.time)
    arrival = complete(limit, tick)
    ticks = arrival - tick + 2 * limit.bit_ticks + SLACK
    if st.calm <= c.time + ticks * (clock.whole + 1):
        return False
    peer.incoming, peer.arrival = message, arrival
    peer.due = min(peer.due, arrival)
    return True


@njit(nogil=True)
def go_out(st: Any, limit: Any, d: int) -> None:
    """A message, or one of its bits, comes to the end of the line's delay."""
    c = st.channels[d]
    s = c.senders[1]
    if s.bit == 0 and whole(st, limit, d, c.sent[s.number % SENT]):
        s.number += 1
        s.next += limit.link_period_ticks
    else:
        send(limit, c, s)
        wire(st, limit, d, s.level, c.time)
