"""Pulse trains in the loop: edge by edge, or, where they are steady, not at all (DRV-13).

A train that nothing disturbs holds its feedback and its stage as they are. It rests: its edges are
neither drawn nor sent to feedback and stage, until something disturbs it or it ends; then its last
periods are run again, so that all is as if every edge had been.
"""

from __future__ import annotations

from typing import Any

from numba import njit

from railgate.vital_output.model.clocks import edge, sampled
from railgate.vital_output.model.pins import head, push, seat, turn
from railgate.vital_output.model.records import FAR, places
from railgate.vital_output.model.trains import reckon
from railgate.vital_output.model.wires import (
    FLIP_FLOPS,
    NO_FILTER,
    OPEN,
    RELAYS,
    ROGUES,
    STUCK,
    feed,
    passed,
    repin,
)

__all__ = ["cease", "disturb", "turn_pulses"]

(PULSES,) = places("pulses")
PERIODS = 3
"""After so many feedback and stage do not remember what was before."""


@njit(nogil=True)
def turn_pulses(st: Any, limit: Any, d: int, tick: int) -> None:
    """Pulses change in the next tick."""
    c, before = st.channels[d], st.channels[d].pulses
    c.toggle = FAR
    for i in range(limit.outputs):
        o = c.outputs[i]
        if o.toggle == tick and not o.steady:
            level, o.toggle = reckon(limit, o, tick + 1)
            c.pulses = c.pulses & ~(1 << i) | level << i
            o.regular += level
            if level and o.regular > PERIODS and may_rest(st, d, i):
                rest(st, d, i)
        c.toggle = min(c.toggle, o.toggle)
    c.shown[PULSES], c.news = c.pulses, 1
    if c.looped and c.pulses != before:
        c.feedback = c.pulses
        repin(limit, c, st.domains[d], tick + 1)
        feed(st, limit, d, sampled(st.clocks[RELAYS], c.time))


@njit(nogil=True)
def may_rest(st: Any, d: int, i: int) -> bool:
    """Whether feedback and stage stay as they are while the train goes on."""
    c, held, relays = st.channels[d], st.domains[d].held, st.domains[RELAYS]
    if not c.restful or (held[OPEN] | held[STUCK]) >> i & 1 or not c.feedback_pins[i].right:
        return False
    if relays.held[ROGUES + d] >> i & 1:
        return True
    return c.leapable == 1 and relays.resetting == 0 and st.relays.stages[d, i].right == 1


@njit(nogil=True)
def rest(st: Any, d: int, i: int) -> None:
    c, bit = st.channels[d], 1 << i
    c.outputs[i].steady, c.outputs[i].toggle = 1, FAR
    c.still |= bit
    c.feedback_pins[i].count = 0
    if not st.domains[RELAYS].held[ROGUES + d] & bit:
        st.relays.still[d] |= bit
        st.relays.stages[d, i].count = 0


@njit(nogil=True)
def disturb(st: Any, limit: Any, d: int, bits: int, time: int) -> None:
    """From this time on these outputs of channel d need attention again."""
    c = st.channels[d]
    for i in range(limit.outputs):
        if bits >> i & 1:
            if c.outputs[i].steady:
                rouse(st, limit, d, i, time)
            c.outputs[i].regular = 0


@njit(nogil=True)
def rouse(st: Any, limit: Any, d: int, i: int, time: int) -> None:
    """A resting train's last periods are run again, up to what has passed at this time."""
    c, r, domain, bit = st.channels[d], st.relays, st.domains[d], 1 << i
    o, pin, stage = c.outputs[i], c.feedback_pins[i], r.stages[d, i]
    last, relays_last = passed(st, d, time), passed(st, RELAYS, time)
    delay = 1 + limit.input_stages + limit.feedback_filter_ticks
    tick = last - (last - o.since) % limit.period_ticks - PERIODS * limit.period_ticks
    staged, level = r.still[d] & bit != 0, 0
    seat(pin)
    if staged:
        seat(stage)
    while tick <= last:
        level ^= 1
        push(pin, tick + delay, limit.feedback_filter_ticks)
        while head(pin) <= last:
            turn(pin, head(pin), limit.period_low_ticks, limit.period_high_ticks)
        if staged:
            at = sampled(st.clocks[RELAYS], edge(st.clocks[d], tick + domain.skipped))
            push(stage, at + FLIP_FLOPS, NO_FILTER)
            while head(stage) <= relays_last:
                turn(stage, head(stage), r.low, r.high)
        tick += limit.half_period_ticks if level else limit.period_ticks - limit.half_period_ticks
    o.steady, o.toggle = 0, tick
    c.still &= ~bit
    c.pulses = c.pulses & ~bit | level << i
    c.feedback = c.feedback & ~bit | level << i
    c.feedback_pin = c.feedback_pin & ~bit | level << i
    c.toggle, c.drive_due, c.due = min(c.toggle, tick), last + 1, last + 1
    if staged:
        r.still[d] &= ~bit
        r.fed[d] = r.fed[d] & ~bit | level << i
        r.due = min(r.due, relays_last + 1)


@njit(nogil=True)
def cease(st: Any, limit: Any, d: int, tick: int) -> None:
    """Resting trains that do not go on after this tick."""
    c = st.channels[d]
    for i in range(limit.outputs):
        if c.ceased >> i & 1:
            rouse(st, limit, d, i, c.time)
            _, c.outputs[i].toggle = reckon(limit, c.outputs[i], tick + 1)
            c.toggle = min(c.toggle, c.outputs[i].toggle)
    c.ceased = 0
