"""Which speeds and ways of the train two or more axles leave possible, strobe by strobe: compiled.

A *hypothesis* is that one axle rolls. Each live axle keeps the train's speeds that its own
hypothesis leaves; the train's are the hull of all of them (a relaxed intersection: one axle of the
live ones is believed, nobody says which). Three inequalities end or doubt a hypothesis:

- *own*: of a rolling wheel, the means over two successive spans of 1, 2 … windows differ by at most
  a_max times the time between their middles, since every pair of instants at the same share of the
  two spans does;
- *reach*: the window's edges, or their silence, leave a speed within a_max · dt of one that was
  possible before;
- *pair*: two rolling wheels' mean speeds over nearly one span stand in a ratio that is a constant
  of the wheels. Their records leave an interval for it, and so does each of the last spans of 1,
  2, 4 … SPAN windows; where these have nothing in common the two are *apart*.

What an axle tells is *confirmed* once it has gone through these for `confirm_ticks`; until then the
train has what it can have become of what is confirmed, so that a slide is found in time, also one
of all axles alike.

All intervals are outward: an edge at t is stamped in [t, t + late), lies within ±tooth pitches of
its place, clock and wheel err by their tolerances, and a rolling wheel's speed differs from the
train's by at most `creep` of it. Speeds are signed, m/s; a *nominal* one is of the nominal clock
and wheel. All kernels stand in this one file, since numba's cache does not see a change elsewhere.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit

from railgate.odometer.spec import Direction, Flag

__all__ = ["AXLE", "PAIR", "RING", "RULES", "SEEN", "SPAN", "TRAIN", "refer", "replay", "tell"]

ADHERING, SLIPPING, SLIDING, LOST = 0, 1, 2, 3
"""As train.Verdict."""
NONE, FORWARD = int(Direction.NONE), int(Direction.FORWARD)
FAULTY = int(Flag.MISMATCH | Flag.A_MISSING | Flag.B_MISSING | Flag.PHASE_FAULT | Flag.ILLEGAL)
"""What says that edges are lost or false: the axle is not believed."""
EDGE, RISES, EPOCH, TIME = 0, 1, 2, 3
"""The columns of `past`."""
SPAN = 64
"""The longest span, windows, over which two axles are compared."""
RING = 128
"""Strobes that are remembered: a power of two above SPAN."""
OUTWARD = 2.0**-44


def _dtype(integers: str, reals: str) -> np.dtype[Any]:
    return np.dtype(
        [(name, np.int64) for name in integers.split()]
        + [(name, np.float64) for name in reals.split()]
    )


SEEN = _dtype(
    "time a_rising since_rise since_edge position direction direction_changes "
    "illegal_transitions window_seated window_n window_ticks flags",
    "",
)
"""What of an axle's snapshot is used; the fields of `readout.Snapshot` by their names."""
RULES = _dtype(
    "time_modulus count_modulus still_ticks rejoin_ticks confirm_ticks delay_ticks",
    "tick_s tick_min_s tick_max_s clock_low a_max slide_rise tooth late creep",
)
"""The assumptions. clock_low: least factor on a nominal speed that the clock leaves."""
AXLE = _dtype(
    "verdict live suspect doubted faulty rolled position moved counted anchor start edge rises "
    "epoch n ticks since run raw_position raw_rising changes illegal seated",
    "pitch wheel_low wheel_high low high "
    "told_low told_high met_low met_high speed_low speed_high way_low way_high",
)
"""One axle. live: its hypothesis is possible. suspect: of two that are apart the likelier one to
be off, `doubted` since that tick. faulty: its edges were false, and it has not been believed since.
rolled: never in doubt since `start`, the position at the reference. position, moved: unwrapped
steps, in all and since the last strobe; counted: those that the train's way is told by. rises,
edge: rising edges, tick of the last; epoch: counts what breaks their order. n, ticks, since: the
window's periods (0: no measurement), their ticks, ticks from their end to the strobe. low, high:
its nominal mean speed. told_: the train's speed at the strobe, as the axle alone tells it; met_,
speed_: within what was possible. run: ticks for which it has kept within its own limits. anchor:
the position at which the train's way was way_. raw_ … seated: as last seen."""
PAIR = _dtype("apart", "low high")
"""Two axles i < j. low, high: (true over nominal way) of i over the same of j, by their records.
apart: the span that shows that they do not roll together, 0: none."""
TRAIN = _dtype(
    "started time raw_time strobe free heading still",
    "speed_low speed speed_high way_low way_high compensated",
)
"""The train. free: no axle is live. heading: in which it went, 1 or -1. still: see train.
speed: the likeliest one. compensated: metres made with it while free."""


@njit(cache=True, nogil=True)
def _window(axle: Any, seen: Any, at: int, rules: Any) -> None:
    """The counts since the last strobe, and the nominal mean speed between rising edges."""
    half = rules.count_modulus // 2
    moved = (seen.position - axle.raw_position + half) % rules.count_modulus - half
    rises = (seen.a_rising - axle.raw_rising) % rules.count_modulus
    turned = seen.direction_changes != axle.changes or seen.illegal_transitions != axle.illegal
    clean = seen.window_seated != 0 and axle.seated != 0 and not turned
    axle.position, axle.moved = axle.position + moved, moved
    axle.rises += rises
    axle.epoch += 0 if clean else 1
    edge = at - seen.since_rise
    axle.n, axle.ticks = (rises, edge - axle.edge) if clean else (seen.window_n, seen.window_ticks)
    if not seen.window_seated or seen.direction == NONE or axle.ticks <= rules.late:
        axle.n = 0
    axle.edge, axle.since = edge, seen.since_rise
    axle.raw_position, axle.raw_rising = seen.position, seen.a_rising
    axle.changes, axle.illegal = seen.direction_changes, seen.illegal_transitions
    axle.seated = seen.window_seated
    if axle.n:
        low, high = _nominal(axle.n, axle.ticks, axle.pitch, rules)
        ahead = seen.direction == FORWARD
        axle.low, axle.high = (low, high) if ahead else (-high, -low)


@njit(cache=True, nogil=True)
def _nominal(n: int, ticks: int, pitch: float, rules: Any) -> Any:
    """The least and the greatest nominal mean speed that n periods of so many ticks leave."""
    unit = pitch / rules.tick_s
    slow = (n - 2 * rules.tooth) / (ticks + rules.late) * unit * (1 - OUTWARD)
    return slow, (n + 2 * rules.tooth) / (ticks - rules.late) * unit * (1 + OUTWARD)


@njit(cache=True, nogil=True)
def _true(axle: Any, low: float, high: float, rules: Any) -> Any:
    """The train's speeds of nominal ones of a rolling wheel."""
    least = rules.clock_low * axle.wheel_low / (1 + rules.creep)
    most = axle.wheel_high / rules.clock_low / (1 - rules.creep)
    return low * (least if low > 0 else most), high * (most if high > 0 else least)


@njit(cache=True, nogil=True)
def _trailing(axle: Any, rules: Any) -> Any:
    """The greatest speed that the time since the last rising edge leaves: estimators.present."""
    way = axle.pitch * axle.wheel_high * (1 + 2 * rules.tooth) / (1 - rules.creep)
    quiet = max(axle.since - rules.delay_ticks - rules.late, 0.0) * rules.tick_min_s
    if quiet == 0.0:
        return math.inf
    best = min(quiet, math.sqrt(2 * way / rules.a_max))
    late = rules.a_max * rules.delay_ticks * rules.tick_max_s
    return (way / best + rules.a_max * best / 2 + late) * (1 + OUTWARD)


@njit(cache=True, nogil=True)
def _told(axle: Any, rules: Any) -> Any:
    """The train's speeds at the strobe that the window alone leaves, if the wheel rolls."""
    most = _trailing(axle, rules)
    low, high = -most, most
    if axle.n:
        since = axle.since + axle.ticks / 2 + rules.late + rules.delay_ticks
        change = rules.a_max * since * rules.tick_max_s * (1 + OUTWARD)
        mean_low, mean_high = _true(axle, axle.low, axle.high, rules)
        low, high = max(low, mean_low - change), min(high, mean_high + change)
    return low, high


@njit(cache=True, nogil=True)
def _own(axle: Any, past: Any, strobe: int, rules: Any) -> int:
    """1 or -1 where the wheel's signed speed rose or fell faster than the train's can, else 0."""
    span, now = 1, strobe % RING
    while axle.n and 2 * span <= min(SPAN, strobe):
        mid, old = (strobe - span) % RING, (strobe - 2 * span) % RING
        n, ticks = past[now, RISES] - past[mid, RISES], past[now, EDGE] - past[mid, EDGE]
        m, before = past[mid, RISES] - past[old, RISES], past[mid, EDGE] - past[old, EDGE]
        if past[now, EPOCH] != past[old, EPOCH]:
            return 0
        if min(n, m) > 0 and min(ticks, before) > rules.late:
            slow, fast = _nominal(n, ticks, axle.pitch, rules)
            slower, faster = _nominal(m, before, axle.pitch, rules)
            most = max(fast, faster) * axle.wheel_high / rules.clock_low
            apart = (ticks + before) / 2 + rules.late
            slack = rules.a_max * apart * rules.tick_max_s + 2 * rules.creep * most
            least, ahead = rules.clock_low * axle.wheel_low, 1 if axle.high > 0 else -1
            if least * (slow - faster) > slack:
                return ahead
            if least * (slower - fast) > slack:
                return -ahead
        span *= 2
    return 0


@njit(cache=True, nogil=True)
def _possible(axles: Any, i: int, change: float) -> None:
    """met: what axle i tells, within `change` of what was possible; a live one may follow any."""
    axle = axles[i]
    axle.met_low, axle.met_high = math.inf, -math.inf
    for k in range(axles.size):
        if k == i or (axle.live and axles[k].live):
            low = max(axle.told_low, axles[k].speed_low - change)
            high = min(axle.told_high, axles[k].speed_high + change)
            if low <= high:
                axle.met_low, axle.met_high = min(axle.met_low, low), max(axle.met_high, high)


@njit(cache=True, nogil=True)
def _decide(axle: Any, past: Any, flags: int, dt: int, train: Any, rules: Any) -> None:
    """The axle by itself: its hypothesis goes on, or ends, or runs towards being believed again."""
    own = _own(axle, past, train.strobe, rules)
    if own == 0 and axle.met_low <= axle.met_high and not flags & FAULTY:
        axle.run += dt if axle.n else 0
        axle.speed_low, axle.speed_high = axle.met_low, axle.met_high
        return
    if flags & FAULTY:
        axle.verdict, axle.faulty = LOST, 1
    elif axle.live:
        faster = own
        if own == 0:
            faster = axle.told_low + axle.told_high > train.speed_low + train.speed_high
            faster = 1 if faster else -1
        axle.verdict = SLIPPING if faster * train.heading > 0 else SLIDING
    axle.live, axle.suspect, axle.rolled, axle.run = 0, 0, 0, 0
    axle.epoch += 1
    past[train.strobe % RING, EPOCH] = axle.epoch
    axle.speed_low = min(axle.told_low, axle.told_high)
    axle.speed_high = max(axle.told_low, axle.told_high)


@njit(cache=True, nogil=True)
def _ratio(axles: Any, i: int, j: int, past: Any, h: int, k: int, rules: Any) -> Any:
    """What the ways of i and j from strobe h to strobe k leave of their ratio; (0, inf): all."""
    a, b = past[i], past[j]
    same = a[h, EPOCH] == a[k, EPOCH] and b[h, EPOCH] == b[k, EPOCH]
    n, m, ticks, others = (
        a[k, RISES] - a[h, RISES],
        b[k, RISES] - b[h, RISES],
        a[k, EDGE] - a[h, EDGE],
        b[k, EDGE] - b[h, EDGE],
    )
    if not same or n < 1 or m < 1 or min(ticks, others) <= rules.late:
        return 0.0, math.inf
    slow, fast = _nominal(n, ticks, axles[i].pitch, rules)
    other_slow, other_fast = _nominal(m, others, axles[j].pitch, rules)
    shift = (abs(a[h, EDGE] - b[h, EDGE]) + abs(a[k, EDGE] - b[k, EDGE])) / 2 + rules.late
    least = rules.clock_low * axles[j].wheel_low / (1 + rules.creep)
    drift = rules.a_max * shift * rules.tick_max_s / least
    if other_slow <= drift:
        return 0.0, math.inf
    grip = (1 + rules.creep) / (1 - rules.creep)
    return (other_slow - drift) / fast / grip, (other_fast + drift) / slow * grip


@njit(cache=True, nogil=True)
def _compare(axles: Any, i: int, j: int, past: Any, pair: Any, strobe: int, rules: Any) -> int:
    """The span, windows, that shows that i and j do not roll together, 0 where they do."""
    low, high, span = pair.low, pair.high, SPAN
    while span:
        if span <= strobe:
            then, now = (strobe - span) % RING, strobe % RING
            slow, fast = _ratio(axles, i, j, past, then, now, rules)
            low, high = max(low, slow), min(high, fast)
            if low > high:
                return span
        span //= 2
    return 0


@njit(cache=True, nogil=True)
def _gain(axle: Any, past: Any, strobe: int, span: int) -> Any:
    """By how much the nominal speed, metres per tick, rose from the last but one span to the last.

    NaN where the spans are not whole.
    """
    if strobe < 2 * span:
        return math.nan
    now, mid, old = strobe % RING, (strobe - span) % RING, (strobe - 2 * span) % RING
    if past[old, EPOCH] != past[now, EPOCH]:
        return math.nan
    ticks, before = past[now, EDGE] - past[mid, EDGE], past[mid, EDGE] - past[old, EDGE]
    if min(ticks, before) <= 0:
        return math.nan
    n, m = past[now, RISES] - past[mid, RISES], past[mid, RISES] - past[old, RISES]
    return axle.pitch * (n / ticks - m / before)


@njit(cache=True, nogil=True)
def _suspect(axles: Any, i: int, j: int, past: Any, strobe: int, span: int, time: int) -> None:
    """Of two that went apart, the one that changed its speed more is the likelier one to be off."""
    gain, other, span = math.nan, math.nan, min(span, SPAN // 2)
    while span and (math.isnan(gain) or math.isnan(other)):
        gain = _gain(axles[i], past[i], strobe, span)
        other = _gain(axles[j], past[j], strobe, span)
        span //= 2
    first = abs(gain) > abs(other)
    axle = axles[i if first else j]
    axle.suspect, axle.doubted = 1, time
    axle.verdict = SLIPPING if (gain > other) == first else SLIDING


@njit(cache=True, nogil=True)
def _pairs(axles: Any, past: Any, pairs: Any, strobe: int, time: int, rules: Any) -> bool:
    """Compare all pairs; whether live ones that were apart agree again."""
    again = False
    for j in range(axles.size):
        for i in range(j):
            pair = pairs[i, j]
            was, live = pair.apart, bool(axles[i].live and axles[j].live)
            pair.apart = _compare(axles, i, j, past, pair, strobe, rules)
            if pair.apart and live:
                axles[i].rolled = axles[j].rolled = 0
                if not axles[i].suspect and not axles[j].suspect:
                    _suspect(axles, i, j, past, strobe, pair.apart, time)
            again = again or (was and not pair.apart and live)
    return again


@njit(cache=True, nogil=True)
def _clear(axles: Any, pairs: Any) -> None:
    """A live axle adheres unless it is suspect, and it is that while apart from a live one."""
    for i in range(axles.size):
        apart = False
        for k in range(axles.size):
            apart = apart or bool(k != i and axles[k].live and pairs[min(i, k), max(i, k)].apart)
        if not (axles[i].live and apart):
            axles[i].suspect = 0
        if axles[i].live and not axles[i].suspect:
            axles[i].verdict = ADHERING


@njit(cache=True, nogil=True)
def _fits(axles: Any, i: int, pairs: Any, train: Any, rules: Any) -> bool:
    """Whether axle i, not live, has rolled long enough, and with another, to be believed again."""
    axle = axles[i]
    if axle.run < rules.rejoin_ticks or not axle.n:
        return False
    if axle.speed_low > train.speed_high or axle.speed_high < train.speed_low:
        return False
    alone, agreed = True, False
    for k in range(axles.size):
        other = axles[k]
        if k == i or (not other.live and other.verdict == LOST):
            continue
        alone = False
        ran = other.live or (train.free and other.n and other.run >= rules.rejoin_ticks)
        together = ran and not pairs[min(i, k), max(i, k)].apart
        meet = axle.speed_low <= other.speed_high and other.speed_low <= axle.speed_high
        agreed = agreed or bool(together and meet)
    return agreed or (alone and axle.run >= rules.still_ticks)


@njit(cache=True, nogil=True)
def _coast(low: float, high: float, a: float, rise: float, dt: float) -> Any:
    """What [low, high] becomes in dt, ahead being positive, and the way: (low, high, least, most).

    The speed falls by at most a, down to rest, and rises by at most `rise`.
    """
    braked = min(dt, low / a) if low > 0 else 0.0
    least = low * braked - a * braked * braked / 2 if low > 0 else low * dt
    fastest = max(high + rise * dt, 0.0)
    most = (max(high, 0.0) + fastest) / 2 * dt
    return max(low - a * dt, min(low, 0.0)), fastest, least, most


@njit(cache=True, nogil=True)
def _free(axles: Any, train: Any, rules: Any, dt: float) -> None:
    """No axle is live: what the train can have become by its own limits (ODO-11, ODO-15).

    The likeliest speed falls by half of the train's greatest deceleration, as far as it can.
    A sliding wheel is never faster than the train and a slipping one never slower, nor are their
    means over a window.
    """
    ahead, slides, slips = train.heading > 0, 0, 0
    for k in range(axles.size):
        slips += 1 if axles[k].verdict == SLIPPING else 0
        slides += 1 if axles[k].verdict != SLIPPING and not axles[k].faulty else 0
    sliding, slipping = slides > 0 and not slips, slips == axles.size
    low, high = train.speed_low, train.speed_high
    low, high = (low, high) if ahead else (-high, -low)
    rise = rules.slide_rise if train.free and sliding else rules.a_max
    low, high, least, most = _coast(low, high, rules.a_max, rise, dt)
    for k in range(axles.size):
        axle = axles[k]
        if axle.n and not axle.faulty:
            since = axle.since + axle.ticks / 2 + rules.late + rules.delay_ticks
            change = rules.a_max * since * rules.tick_max_s
            slow, fast = _true(axle, axle.low, axle.high, rules)
            slow, fast = (slow, fast) if ahead else (-fast, -slow)
            low = max(low, slow - change) if sliding else low
            high = min(high, fast + change) if slipping else high
    high = max(high, low)
    way = (least, most) if ahead else (-most, -least)
    train.way_low, train.way_high = train.way_low + way[0], train.way_high + way[1]
    train.speed_low, train.speed_high = (low, high) if ahead else (-high, -low)
    was, change = train.speed, (rise - rules.a_max) / 2 * dt
    train.speed = was + change if ahead else was - change
    train.speed = min(max(train.speed, train.speed_low), train.speed_high)
    train.compensated += (was + train.speed) / 2 * dt


@njit(cache=True, nogil=True)
def _way(axle: Any, rules: Any, fastest: float) -> Any:
    """The train's way since its reference if the axle has rolled since its anchor, metres.

    At either end the wheel is within one pitch of the place that its steps tell, whatever the duty
    and the phase, and it has moved on for the input's delay.
    """
    least, most = axle.wheel_low / (1 + rules.creep), axle.wheel_high / (1 - rules.creep)
    steps = (axle.position - axle.anchor) * axle.pitch / 4
    seam = axle.pitch * most * (1 + 2 * rules.tooth)
    seam += 2 * fastest * (rules.delay_ticks + rules.late) * rules.tick_max_s
    low = axle.way_low + steps * (least if steps > 0 else most) - seam
    return low, axle.way_high + steps * (most if steps > 0 else least) + seam


@njit(cache=True, nogil=True)
def _since(told: Any, past: Any, strobe: int, rules: Any) -> Any:
    """What an axle's speeds and ways, confirmed some time ago, have become by this strobe."""
    now, back = strobe % RING, 0
    while back < min(SPAN, strobe):
        back += 1
        then = (strobe - back) % RING
        if past[now, TIME] - past[then, TIME] >= rules.confirm_ticks:
            break
    then = (strobe - back) % RING
    low, high, way_low, way_high = told[then]
    if back:
        dt = (past[now, TIME] - past[then, TIME]) * rules.tick_max_s
        bend = rules.a_max * dt * dt / 2
        way_low, way_high = way_low + low * dt - bend, way_high + high * dt + bend
        low, high = low - rules.a_max * dt, high + rules.a_max * dt
    return low, high, way_low, way_high


@njit(cache=True, nogil=True)
def _hull(axles: Any, told: Any, past: Any, train: Any, rules: Any) -> None:
    """The train's speeds and ways over all live hypotheses; its way is counted by the best one."""
    low, high, k = math.inf, -math.inf, train.strobe % RING
    way_low, way_high, counts = math.inf, -math.inf, False
    for i in range(axles.size):
        axle = axles[i]
        if axle.live:
            fastest = max(abs(axle.speed_low), abs(axle.speed_high))
            least, most = _way(axle, rules, fastest if fastest < math.inf else 0.0)
            told[i, k] = axle.speed_low, axle.speed_high, least, most
            slow, fast, least, most = _since(told[i], past[i], train.strobe, rules)
            low, high = min(low, slow), max(high, fast)
            way_low, way_high = min(way_low, least), max(way_high, most)
            if not counts and not axle.suspect:
                axle.counted += axle.moved
                middle = (axle.speed_low + axle.speed_high) / 2
                train.speed = middle if abs(middle) < math.inf else 0.0
                counts = True
    train.speed_low, train.speed_high = low, high
    train.way_low, train.way_high = way_low, way_high
    if low + high != 0.0 and abs(low + high) < math.inf:
        train.heading = 1 if low + high > 0 else -1


@njit(cache=True, nogil=True)
def _anchor(axle: Any, told: Any, train: Any) -> None:
    """From this strobe on the axle tells the train's way, from all that is possible now."""
    axle.anchor, axle.way_low, axle.way_high = axle.position, train.way_low, train.way_high
    now = train.speed_low, train.speed_high, train.way_low, train.way_high
    told[train.strobe % RING] = now


@njit(cache=True, nogil=True)
def _off(axle: Any, seen: Any, train: Any, rules: Any) -> None:
    """The verdict on an axle that is not live."""
    moving = train.speed_low > 0 or train.speed_high < 0
    if not axle.n:
        if seen.since_edge >= rules.still_ticks and moving:
            axle.verdict = LOST
    elif not seen.flags & FAULTY:
        slow, fast = _true(axle, axle.low, axle.high, rules)
        low, high = train.speed_low, train.speed_high
        if train.heading < 0:
            slow, fast, low, high = -fast, -slow, -high, -low
        if slow > high:
            axle.verdict = SLIPPING
        elif fast < low or axle.verdict == LOST:
            axle.verdict = SLIDING


@njit(cache=True, nogil=True)
def _return(
    axles: Any, seen: Any, past: Any, told: Any, pairs: Any, train: Any, rules: Any
) -> None:
    """Axles that are not live are believed again, or judged."""
    for i in range(axles.size):
        axle = axles[i]
        if not axle.live and _fits(axles, i, pairs, train, rules):
            axle.live, axle.verdict, axle.faulty, axle.epoch = 1, ADHERING, 0, axle.epoch + 1
            past[i, train.strobe % RING, EPOCH] = axle.epoch
            axle.speed_low = max(axle.speed_low, train.speed_low)
            axle.speed_high = min(axle.speed_high, train.speed_high)
            _anchor(axle, told[i], train)
        elif not axle.live:
            _off(axle, seen[i], train, rules)


@njit(cache=True, nogil=True)
def _doubt(axles: Any, past: Any, train: Any, rules: Any) -> int:
    """How many hypotheses live. One that has long been suspect ends with the last that was not."""
    lives, sound = 0, False
    for i in range(axles.size):
        axle = axles[i]
        fresh = axle.suspect and train.time - axle.doubted < rules.confirm_ticks
        sound = sound or bool(axle.live and (not axle.suspect or fresh))
    for i in range(axles.size):
        axle = axles[i]
        if axle.live and not sound:
            axle.live, axle.suspect, axle.run, axle.epoch = 0, 0, 0, axle.epoch + 1
            past[i, train.strobe % RING, EPOCH] = axle.epoch
        lives += axle.live
    return lives


@njit(cache=True, nogil=True)
def _look(axles: Any, seen: Any, past: Any, train: Any, rules: Any, dt: int) -> Any:
    """What each axle tells by itself; how many hypotheses live on."""
    k = train.strobe % RING
    for i in range(axles.size):
        axle = axles[i]
        _window(axle, seen[i], train.time, rules)
        if not train.started:
            axle.position = axle.moved = 0
        axle.told_low, axle.told_high = _told(axle, rules)
        past[i, k, EDGE], past[i, k, RISES] = axle.edge, axle.rises
        past[i, k, EPOCH], past[i, k, TIME] = axle.epoch, train.time
    for i in range(axles.size):
        _possible(axles, i, rules.a_max * dt * rules.tick_max_s * (1 + OUTWARD))
    for i in range(axles.size):
        flags = seen[i].flags if train.started else 0  # the first ones are of before
        _decide(axles[i], past[i], flags, dt, train, rules)
    return _doubt(axles, past, train, rules)


@njit(cache=True, nogil=True)
def step(axles: Any, seen: Any, past: Any, told: Any, pairs: Any, train: Any, rules: Any) -> None:
    """One strobe.

    axles: shape (n,), AXLE. seen: shape (n,), SEEN. past: int64, shape (n, RING, 4), and told:
    float64, shape (n, RING, 4), each axle's edges, and speeds and ways (low, high, low, high),
    at the last strobes. pairs: shape (n, n), PAIR. train, rules: one TRAIN, one RULES.
    """
    dt = (seen[0].time - train.raw_time) % rules.time_modulus if train.started else 0
    train.raw_time, train.time = seen[0].time, train.time + dt
    lives = _look(axles, seen, past, train, rules, dt)
    again = _pairs(axles, past, pairs, train.strobe, train.time, rules)
    _clear(axles, pairs)
    if lives:
        _hull(axles, told, past, train, rules)
    else:
        _free(axles, train, rules, dt * rules.tick_max_s)
    for i in range(axles.size):
        if again and axles[i].live:
            _anchor(axles[i], told[i], train)
    train.free, train.still = 0 if lives else 1, 1
    _return(axles, seen, past, told, pairs, train, rules)
    for i in range(axles.size):
        axle = axles[i]
        if not axle.live:
            now = train.speed_low, train.speed_high, train.way_low, train.way_high
            told[i, train.strobe % RING] = now
        still = axle.verdict == ADHERING and seen[i].since_edge >= rules.still_ticks
        train.still = train.still if still else 0
        axle.rolled = axle.rolled if axle.verdict == ADHERING else 0
    train.strobe, train.started = train.strobe + 1, 1


@njit(cache=True, nogil=True)
def tell(
    axles: Any, seen: Any, past: Any, told: Any, pairs: Any, trains: Any, rules: Any, out: Any
) -> None:
    """One strobe; trains, rules: shape (1,). out: float64, takes what `_report` tells."""
    step(axles, seen, past, told, pairs, trains[0], rules[0])
    _report(axles, trains[0], out)


@njit(cache=True, nogil=True)
def _report(axles: Any, train: Any, out: Any) -> None:
    """The train's speed, bounds, way's bounds, way, compensated way and standstill, then of each
    axle its verdict, steps, counted steps and whether it rolled; whole numbers below 2⁵³."""
    out[0], out[1], out[2] = train.speed, train.speed_low, train.speed_high
    out[3], out[4], out[5] = train.compensated, train.way_low, train.way_high
    out[6], out[7] = train.compensated, train.still
    n = axles.size
    for i in range(n):
        axle = axles[i]
        out[3] += axle.counted * axle.pitch / 4
        out[8 + i], out[8 + n + i] = axle.verdict, axle.position - axle.start
        out[8 + 2 * n + i], out[8 + 3 * n + i] = axle.counted, axle.rolled
    out[3] = min(max(out[3], train.way_low), train.way_high)


@njit(cache=True, nogil=True)
def refer(
    axles: Any, past: Any, told: Any, trains: Any, rules: Any, tolerance: float, out: Any
) -> None:
    """The train's way is 0 ± tolerance at the last strobe, and what it was before accordingly."""
    train, limits, last = trains[0], rules[0], trains[0].strobe - 1
    train.way_low, train.way_high, train.compensated = -tolerance, tolerance, 0.0
    for i in range(axles.size):
        axle = axles[i]
        axle.anchor, axle.way_low, axle.way_high = axle.position, -tolerance, tolerance
        axle.start, axle.counted = axle.position, 0
        axle.rolled = 1 if axle.verdict == ADHERING else 0
        for back in range(min(SPAN, last) + 1):
            then = (last - back) % RING
            ticks = past[i, last % RING, TIME] - past[i, then, TIME]
            if ticks <= 2 * limits.confirm_ticks:  # none older is asked for
                dt = ticks * limits.tick_max_s
                bend = limits.a_max * dt * dt / 2 if back else 0.0
                told[i, then, 2] = -tolerance - (told[i, then, 1] * dt + bend if back else 0.0)
                told[i, then, 3] = tolerance - (told[i, then, 0] * dt - bend if back else 0.0)
    _report(axles, train, out)


@njit(cache=True, nogil=True)
def replay(
    axles: Any, seen: Any, past: Any, told: Any, pairs: Any, trains: Any, rules: Any, out: Any
) -> None:
    """Many strobes. seen: shape (k, n); out: shape (k, …), a row for each as of `tell`."""
    for k in range(seen.shape[0]):
        step(axles, seen[k], past, told, pairs, trains[0], rules[0])
        _report(axles, trains[0], out[k])
