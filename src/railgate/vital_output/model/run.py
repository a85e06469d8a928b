"""The model's loop over clock edges: one channel alone, or two with line and relays."""

from __future__ import annotations

from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from railgate.vital_output.model.channel import begin, halt, tick_of_channel
from railgate.vital_output.model.clocks import edge, sampled
from railgate.vital_output.model.log import LOG_ROOM, note_down
from railgate.vital_output.model.messages import latch, resume, send
from railgate.vital_output.model.records import FAR, INPUTS, NONE, places
from railgate.vital_output.model.relays import begin_relays, halt_relays, tick_of_relays
from railgate.vital_output.model.repeats import catch_up, renew, repeat
from railgate.vital_output.model.resting import cease, disturb, turn_pulses
from railgate.vital_output.model.trains import reckon
from railgate.vital_output.model.wires import (
    OPEN,
    RELAYS,
    ROGUES,
    STUCK,
    feed,
    go_out,
    passed,
    repin,
    wire,
)

__all__ = ["run"]

RST, STOPPED = INPUTS.index("rst"), INPUTS.index("stopped")
LINK_RX, FEEDBACK, CONTACT = (INPUTS.index(n) for n in ("link_rx", "pulse_feedback", "contact"))
LINK_TX, PULSES = places("link_tx", "pulses")
ALL, QUIET = np.int64(-1), np.int64(1)


@njit(nogil=True)
def step(domain: Any, changes: NDArray[Any]) -> None:
    """The domain's next change."""
    domain.change = changes[domain.cursor, 0] if domain.cursor < len(changes) else FAR


@njit(nogil=True)
def open_piece(st: Any, limit: Any, changes: Any, now: int) -> None:
    """A run goes on: what is asked for may be other signals, and the next tick of a channel is
    looked at whether anything is due in it or not."""
    for d in range(2 if st.loop else 1):
        c = st.channels[d]
        c.restful = c.looped and not c.wanted[PULSES]
        c.drawn = c.looped or c.wanted[PULSES]
        if not st.domains[d].resetting:
            tick = passed(st, d, now) + 1
            c.due = c.drive_due = tick
            if c.wanted[LINK_TX]:
                resume(limit, c, c.senders[0], tick)
                c.shown[LINK_TX] = c.senders[0].level
            else:
                c.senders[0].next = FAR
            if not c.restful:
                disturb(st, limit, d, c.still, now)
            c.toggle = FAR
            for i in range(limit.outputs):
                o = c.outputs[i]
                if c.drawn and not o.steady:
                    level, o.toggle = reckon(limit, o, tick)
                    c.pulses = c.pulses & ~(1 << i) | level << i
                    c.toggle = min(c.toggle, o.toggle)
            c.shown[PULSES] = c.pulses
        c.logged = c.shown
    st.logged, st.disturbance = st.relays.contact, 0
    for d in range(3):
        st.domains[d].cursor = 0
        step(st.domains[d], changes[d])


@njit(nogil=True)
def look(st: Any, d: int) -> None:
    """When is the domain's next edge that matters?"""
    domain = st.domains[d]
    event = domain.change
    if d == RELAYS:
        event = min(event, st.relays.due)
    elif domain.frozen == NONE:
        c = st.channels[d]
        due = min(min(c.due, c.latch), min(c.toggle, min(c.senders[0].next, c.senders[1].next)))
        event = min(event, due + domain.skipped)
    if event != domain.event:
        domain.event = event
        domain.time = edge(st.clocks[d], event) if event < FAR else FAR


@njit(nogil=True)
def sample_relays(st: Any, limit: Any, changes: NDArray[Any]) -> None:
    """What the relays' inputs are in the tick of their event."""
    domain = st.domains[RELAYS]
    held, tick = domain.held, domain.event
    while domain.change <= tick:
        which, value = changes[domain.cursor, 1], changes[domain.cursor, 2]
        if which == ROGUES or which == ROGUES + 1:
            disturb(st, limit, which - ROGUES, held[which] ^ value, domain.time)
        held[which] = value
        domain.cursor += 1
        step(domain, changes)
    if domain.resetting and not held[RST]:
        domain.resetting = 0
        begin_relays(st, limit, tick)
    elif not domain.resetting:
        st.relays.due = tick
        for d in range(2):
            feed(st, limit, d, tick)


@njit(nogil=True)
def sample_channel(st: Any, limit: Any, d: int, changes: NDArray[Any]) -> None:
    """What a channel's inputs are in the tick of its event, and whether its clock runs."""
    domain, c = st.domains[d], st.channels[d]
    held = domain.held
    while domain.change <= domain.event:
        which, value = changes[domain.cursor, 1], changes[domain.cursor, 2]
        if which in (OPEN, STUCK):
            disturb(st, limit, d, held[which] ^ value, domain.time)
        if which == STOPPED and value != held[which]:
            disturb(st, limit, d, ALL, domain.time)
            if not value:
                domain.skipped += domain.event - domain.frozen
            domain.frozen = domain.event if value else NONE
        held[which] = value
        domain.cursor += 1
        step(domain, changes)
    if domain.frozen == NONE:
        tick = domain.event - domain.skipped
        if not c.looped:
            c.feedback, c.contact, c.line = held[FEEDBACK], held[CONTACT], held[LINK_RX]
        repin(limit, c, domain, tick)
        c.due = tick
        if domain.resetting and not held[RST]:
            domain.resetting = 0
            begin(limit, c, domain, tick)


@njit(nogil=True)
def sample(st: Any, limit: Any, d: int, changes: NDArray[Any]) -> None:
    """What a domain's inputs are in the tick of its event."""
    domain = st.domains[d]
    if d == RELAYS:
        sample_relays(st, limit, changes)
    elif domain.change <= domain.event or domain.resetting:
        sample_channel(st, limit, d, changes)


@njit(nogil=True)
def reset_channel(st: Any, limit: Any, d: int) -> None:
    """A channel is as at start from the next tick on, and so are its wires."""
    domain, c = st.domains[d], st.channels[d]
    if not domain.resetting:
        domain.resetting = 1
        disturb(st, limit, d, ALL, c.time)
        halt(limit, c)
        if c.looped:
            c.feedback = 0
            wire(st, limit, d, QUIET, c.time)
            feed(st, limit, d, sampled(st.clocks[RELAYS], c.time))
    c.due = FAR


@njit(nogil=True)
def act_channel(st: Any, limit: Any, d: int) -> None:
    """What a channel does in the tick of its event."""
    domain, c = st.domains[d], st.channels[d]
    c.time = domain.time
    if domain.held[RST]:  # also where the clock is stopped
        reset_channel(st, limit, d)
    if domain.frozen != NONE:
        return
    tick = domain.event - domain.skipped
    domain.done = tick
    if domain.resetting:
        return
    if tick == c.latch:
        catch_up(st, limit, d, tick - 1)
        latch(limit, c)
    if tick == c.toggle:
        turn_pulses(st, limit, d, tick)
    if tick == c.senders[0].next:
        send(limit, c, c.senders[0])
        c.shown[LINK_TX], c.news = c.senders[0].level, 1
    if tick == c.senders[1].next:
        go_out(st, limit, d)
    if tick == c.due:
        tick_of_channel(limit, c, domain, tick)
        if c.ceased:
            cease(st, limit, d, tick)
        if c.renewed:
            renew(st, limit, d, tick)
        if c.heard:
            repeat(st, limit, 1 - d)


@njit(nogil=True)
def act_relays(st: Any, limit: Any) -> None:
    """What the relays do in the tick of their event."""
    domain = st.domains[RELAYS]
    tick = domain.event
    if domain.held[RST]:
        if not domain.resetting:
            domain.resetting = 1
            for d in range(2):
                disturb(st, limit, d, ALL, domain.time)
            halt_relays(st, limit, domain.time)
        st.relays.due = FAR
        domain.done = tick
        return
    domain.done = tick
    tick_of_relays(st, limit, tick, domain.time)


@njit(nogil=True)
def act(st: Any, limit: Any, d: int) -> None:
    """What a domain does in the tick of its event."""
    if d == RELAYS:
        act_relays(st, limit)
    else:
        act_channel(st, limit, d)


def compiled(sources: str) -> Any:
    """The loop for these sources. numba's cache looks at this file and at what a kernel closes
    over, not at the files of those that it calls: so it closes over a digest of them."""

    @njit(cache=True, nogil=True)
    def run(
        st_of: Any,
        limit_of: Any,
        changes: tuple[NDArray[Any], NDArray[Any], NDArray[Any]],
        calm: NDArray[Any],
        log: NDArray[Any],
        now: int,
        until: int,
    ) -> bool:
        """Run all edges before `until`; True if the log is full before that.

        st_of, limit_of: shape (1,), STATE and LIMITS. changes: of each domain's inputs, in rows of
        edge, input and value. calm: when the lines are disturbed, last of all `until`. log: of
        railgate.vital_output.model.log.
        """
        st, limit = st_of[0], limit_of[0]
        domains = 3 if st.loop else 1
        if st.fresh and sources:
            open_piece(st, limit, changes, now)
            st.fresh = 0
        while True:
            time = np.int64(FAR)
            for d in range(domains):
                look(st, d)
                time = min(time, st.domains[d].time)
            if time >= until or log[0, 0] + LOG_ROOM > len(log):
                return bool(time < until)
            while calm[st.disturbance] < time - st.reach:
                st.disturbance += 1
            st.calm = calm[st.disturbance]
            # All that have an edge now sample before any of them changes anything.
            for d in range(domains):
                if st.domains[d].time == time:
                    sample(st, limit, d, changes[d])
            for d in range(domains):
                if st.domains[d].time == time:
                    act(st, limit, d)
            note_down(st, time, log)

    return run


run = compiled(
    sha256(
        b"".join(
            path.read_bytes()
            for folder in (Path(__file__).parent, Path(__file__).parents[1] / "spec")
            for path in sorted(folder.glob("*.py"))
        )
    ).hexdigest()
)
