"""Messages of the cross-link that repeat the one before: leapt over, many at once (DRV-6, DRV-17).

While the sender has nothing new to tell, and neither lines nor clocks are disturbed, each message
is taken as the one before was: of all that the receiver remembers only the message's number, its
tick, `window` and `offset_zero` change, the latter two by a fixed step for each. When a message
comes is told by the clocks' edges, whatever came before. So nothing need be done until something
changes what is told, or the window ends; then the numbers are what they would be.
"""

from __future__ import annotations

from typing import Any

from numba import njit

from railgate.vital_output.model.clocks import edge
from railgate.vital_output.model.messages import FIRST_MESSAGE, LATCH, begins_after
from railgate.vital_output.model.records import FAR, SENT, places
from railgate.vital_output.model.wires import complete, label, passed

__all__ = ["catch_up", "renew", "repeat"]

(LINK_TX,) = places("link_tx")


@njit(nogil=True)
def taken_in(st: Any, limit: Any, d: int, number: int) -> int:
    """The peer's tick in which an undisturbed message of channel d is there."""
    c = st.channels[d]
    out = begins_after(limit, c, c.senders[1], number) + st.domains[d].skipped
    return complete(limit, label(st, 1 - d, edge(st.clocks[d], out)))


@njit(nogil=True)
def off(st: Any, limit: Any, d: int, count: int) -> int:
    """How far the peer finds channel d's clock off after so many more messages."""
    c, r = st.channels[d], st.channels[1 - d].now
    period = count * limit.link_period_ticks
    return taken_in(st, limit, d, c.sends - 1 + count) + 1 - r.offset_zero - period


@njit(nogil=True)
def repeat(st: Any, limit: Any, d: int) -> None:
    """The peer takes channel d's message, undisturbed: those after it are leapt over if they tell
    the same, up to the window's end, or to more than a message before a disturbance.

    A message comes where its time, which grows evenly, is rounded up to a tick: so none between
    two is further off than the further one of them by more than 1 tick.
    """
    c, peer = st.channels[d], st.channels[1 - d]
    s, r, most = c.senders[1], peer.now, limit.drift_limit_ticks
    if c.wanted[LINK_TX] or s.number != c.sends or s.number <= c.settled:
        return
    period = limit.link_period_ticks * (st.clocks[d].whole + 1)
    count = min(limit.window_messages - 1 - r.window, (st.calm - peer.time) // period - 2)
    if count < 1 or abs(off(st, limit, d, 0)) >= most or abs(off(st, limit, d, count)) >= most:
        return
    c.repeating, s.next, r.taken = 1, FAR, FAR
    c.latch += count * limit.link_period_ticks


@njit(nogil=True)
def catch_up(st: Any, limit: Any, d: int, tick: int) -> None:
    """What has been leapt over of channel d's messages is as if it had been done, up to this tick
    of channel d; one may be on its way."""
    c, peer = st.channels[d], st.channels[1 - d]
    if not c.repeating:
        return
    s, r, period = c.senders[1], peer.now, limit.link_period_ticks
    made = (tick + LATCH - FIRST_MESSAGE - c.origin) // period + 1
    gone = (tick - begins_after(limit, c, s, 0)) // period + 1
    come, taken = gone, taken_in(st, limit, d, gone - 1)
    if taken > passed(st, 1 - d, c.time):
        peer.incoming, peer.arrival = r.peer, taken
        peer.incoming.number = gone - 1 & 255
        come, taken = gone - 1, taken_in(st, limit, d, gone - 2)
    r.number = r.peer.number = come - 1 & 255
    r.taken = taken
    r.window += come - s.number
    r.offset_zero += (come - s.number) * period
    for number in range(max(made - 2, c.sends), made):  # those that may still be read
        c.sent[number % SENT] = r.peer
        c.sent[number % SENT].number = number & 255
    c.sends, c.latch = made, c.origin + FIRST_MESSAGE - LATCH + made * period
    s.number, s.next = gone, begins_after(limit, c, s, gone)
    c.repeating = 0
    peer.due = min(peer.due, min(peer.arrival, taken + limit.lost_ticks))


@njit(nogil=True)
def renew(st: Any, limit: Any, d: int, tick: int) -> None:
    """What channel d tells is another from the next message on that is made."""
    catch_up(st, limit, d, tick)
    st.channels[d].settled = st.channels[d].sends
