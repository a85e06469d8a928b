"""One sensor from event to event, compiled: the odometer model's inner loop (ODO-2 … ODO-12).

All ticks are counted from the model's tick 0; `origin` is the tick 0 of the contract, the first
after the last reset. A sensor's state is one record, so that every event is a short function of
it; only `stride`, which takes whole regular periods, keeps its part of the state in registers.
Everything is int64: sums of up to 64 bits wrap into the sign, which keeps their bits.

All kernels stand in this one file, since numba's cache does not see a change in another.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from railgate.odometer.spec import Config, Direction, Field, Flag
from railgate.waves.waveform import Ticks

__all__ = ["SENSOR", "SNAPSHOT", "edges", "limits", "new_sensor", "run"]

FAR = 1 << 62
"""Later than every tick."""

NONE, FORWARD, REVERSE = int(Direction.NONE), int(Direction.FORWARD), int(Direction.REVERSE)
REVERSAL, ILLEGAL, GLITCH = int(Flag.REVERSAL), int(Flag.ILLEGAL), int(Flag.GLITCH)
MISMATCH, A_MISSING, B_MISSING = int(Flag.MISMATCH), int(Flag.A_MISSING), int(Flag.B_MISSING)
PHASE_FAULT, OVERSPEED = int(Flag.PHASE_FAULT), int(Flag.OVERSPEED)
SATURATED, WINDOW_VOID = int(Flag.SATURATED), int(Flag.WINDOW_VOID)
WINDOW_OVERFLOW = int(Flag.WINDOW_OVERFLOW)

FIELDS: tuple[Field, ...] = Config().sensor_fields
SNAPSHOT = np.dtype([(field.name, np.int64) for field in FIELDS])
"""One snapshot of one sensor: every field of the contract, by its name."""

SENSOR = np.dtype(
    [
        (name, np.int64)
        for name in (
            *("level_a", "level_b", "direction", "position", "direction_changes"),
            *("illegal_transitions", "rejected_glitches", "pulses", "a_rising", "b_rising"),
            *("period", "period_valid", "phase", "phase_direction", "flags"),
            "first_b",  # ticks from the last rise of a to the first later rise of b, or 0
            "unclean",  # a reversal or illegal transition in the period under way
            "faults",  # towards phase_fault_periods
            *("armed", "run_a", "run_b"),
            "seen",  # a has risen since reset
            *("rise", "edge", "either"),  # ticks of the last rise of a, edge, rise of a or b
            "expires",  # the tick in which T reaches period_max, FAR once it has
            *("seated", "boundary", "window_n", "sum_a", "sum_b"),
            "voids",  # the tick in which the window lasts too long, FAR while unseated
        )
    ]
)
"""All that a sensor remembers beside its pins."""

LIMITS = np.dtype(
    [
        (name, np.int64)
        for name in (
            *("filter_ticks", "input_delay_ticks", "period_max", "period_min_ticks"),
            *("watch_ticks", "phase_fault_periods", "missing_pulses", "window_pulses"),
            "count_max",
        )
    ]
)


def limits(config: Config) -> Any:
    """The numbers of a configuration that the kernels need. Shape (1,), LIMITS."""
    count_max = (1 << config.count_bits) - 1
    values = [getattr(config, name) for name in LIMITS.names or () if name != "count_max"]
    return np.array([(*values, count_max)], LIMITS)


def new_sensor(config: Config, origin: int) -> Any:
    """A sensor as after a reset whose new tick 0 is `origin`. Shape (1,), SENSOR."""
    state = np.zeros(1, SENSOR)
    state["rise"] = state["edge"] = state["either"] = origin
    state["expires"], state["voids"] = origin + config.period_max, FAR
    return state


@njit(cache=True, nogil=True)
def event(pins: Ticks, at: int, limit: Any) -> tuple[int, bool]:
    """What the change pins[at] brings: in which tick, and whether it is a rejected glitch."""
    if at >= pins.size:
        return FAR, False
    if at + 1 < pins.size and pins[at + 1] - pins[at] <= limit.filter_ticks:
        return pins[at + 1] + 2, True
    return pins[at] + limit.input_delay_ticks, False


@njit(cache=True, nogil=True)
def void(state: Any) -> None:
    state.flags |= WINDOW_VOID if state.seated else 0
    state.seated = state.window_n = state.sum_a = state.sum_b = 0
    state.voids = FAR


@njit(cache=True, nogil=True)
def seat(state: Any, limit: Any, tick: int) -> None:
    state.seated, state.boundary, state.voids = 1, tick, tick + limit.period_max
    state.window_n = state.sum_a = state.sum_b = 0


@njit(cache=True, nogil=True)
def step(state: Any, edge_a: bool, edge_b: bool) -> None:
    """The levels have changed: position, direction, and what a break in the order spoils."""
    broken = True
    if edge_a and edge_b:
        state.illegal_transitions += 1
        state.flags |= ILLEGAL
        state.direction = NONE
    else:
        heading = FORWARD if (state.level_a != state.level_b) == edge_a else REVERSE
        broken = state.direction != NONE and state.direction != heading
        if broken:
            state.direction_changes += 1
            state.flags |= REVERSAL
        state.direction = heading
        state.position += 1 if heading == FORWARD else -1
    if broken:
        void(state)
        state.unclean = 1


@njit(cache=True, nogil=True)
def close_period(state: Any, limit: Any, tick: int) -> None:
    """A rise of a ends a period: what it was, and whether its phase was right."""
    T = min(tick - state.rise, limit.period_max)
    state.period, state.phase, eighths = T, state.first_b, 8 * state.first_b
    clean = limit.period_max > T and not state.unclean
    watched = clean and limit.watch_ticks >= T
    state.period_valid, state.phase_direction = int(clean), NONE
    if clean and T <= eighths <= 3 * T:
        state.phase_direction = FORWARD
    elif clean and 5 * T <= eighths <= 7 * T:
        state.phase_direction = REVERSE
    if watched and state.phase_direction == NONE:
        state.faults = min(state.faults + 1, limit.phase_fault_periods)
        state.flags |= PHASE_FAULT if state.faults == limit.phase_fault_periods else 0
    else:
        state.faults = 0
    if clean:
        state.armed = int(watched)
    state.flags |= OVERSPEED if clean and limit.period_min_ticks > T else 0


@njit(cache=True, nogil=True)
def rise_of_a(state: Any, limit: Any, tick: int) -> None:
    state.pulses += 1
    state.a_rising += 1
    if state.seen:
        close_period(state, limit, tick)
    state.seen, state.rise, state.expires = 1, tick, tick + limit.period_max
    state.first_b = state.unclean = 0
    if state.seated and state.window_n == limit.window_pulses:
        state.flags |= WINDOW_OVERFLOW
        void(state)
    if state.seated:
        state.window_n += 1
        state.sum_a += tick - state.boundary
        state.sum_b += state.sum_a
    else:
        seat(state, limit, tick)


@njit(cache=True, nogil=True)
def count_runs(state: Any, limit: Any, rise_a: bool, rise_b: bool) -> None:
    """Rises of one channel without one of the other."""
    state.run_a = 0 if rise_b else min(state.run_a + 1, limit.missing_pulses)
    state.run_b = 0 if rise_a else min(state.run_b + 1, limit.missing_pulses)
    run = max(state.run_a, state.run_b)
    state.flags |= MISMATCH if run >= 2 and state.armed else 0
    if run == limit.missing_pulses:
        state.flags |= B_MISSING if rise_a else A_MISSING


@njit(cache=True, nogil=True)
def take_edges(state: Any, limit: Any, edge_a: bool, edge_b: bool, tick: int) -> bool:
    """All that an edge of either channel brings, or both. Returns whether a rose."""
    state.level_a ^= int(edge_a)
    state.level_b ^= int(edge_b)
    state.edge = tick
    step(state, edge_a, edge_b)
    rise_a, rise_b = edge_a and state.level_a == 1, edge_b and state.level_b == 1
    if rise_a or rise_b:
        if tick - state.either > limit.watch_ticks:
            state.run_a = state.run_b = state.armed = 0
        state.either = tick
        if rise_a:
            rise_of_a(state, limit, tick)
        if rise_b:
            state.b_rising += 1
            if not rise_a and state.first_b == 0:
                state.first_b = min(tick - state.rise, limit.period_max)
        count_runs(state, limit, rise_a, rise_b)
    return rise_a


@njit(cache=True, nogil=True)
def latch(state: Any, limit: Any, row: Any, origin: int, tick: int) -> None:
    """The strobe: the snapshot goes into `row`, pulses and flags start afresh, the window goes on.

    Counters run on without end in the state and take their width only here.
    """
    most, half = limit.count_max, (limit.count_max + 1) >> 1
    state.flags |= SATURATED if state.pulses > most else 0
    row.pulses = min(state.pulses, most)
    row.a_rising, row.b_rising = state.a_rising & most, state.b_rising & most
    row.position = ((state.position + half) & most) - half
    row.direction_changes = state.direction_changes & most
    row.illegal_transitions = state.illegal_transitions & most
    row.rejected_glitches = state.rejected_glitches & most
    settled = tick >= origin + 3
    row.level_a, row.level_b = state.level_a * settled, state.level_b * settled
    row.direction, row.phase_direction = state.direction, state.phase_direction
    row.period, row.period_valid, row.phase = state.period, state.period_valid, state.phase
    row.since_rise = min(tick - state.rise, limit.period_max)
    row.since_edge = min(tick - state.edge, limit.period_max)
    row.window_seated, row.window_n = state.seated, state.window_n
    row.window_ticks = state.rise - state.boundary if state.seated else 0
    row.sum_a, row.sum_b, row.flags = state.sum_a, state.sum_b, state.flags
    state.pulses = state.flags = 0
    if state.seated and state.window_n:
        seat(state, limit, state.rise)


@njit(cache=True, nogil=True)
def stride(
    state: Any, limit: Any, a: Ticks, at_a: int, b: Ticks, at_b: int, last: int
) -> tuple[int, int]:
    """From a rise of a on, take every whole period that is regular and ends by tick `last`.

    Regular: the four edges in the order of the direction, each held longer than the filter's
    ticks, period and phase such that nothing is flagged, the window neither full nor too old.
    Returns the indices of the changes that follow. Ticks here are those of the pins.
    """
    delay, hold, forward = limit.input_delay_ticks, limit.filter_ticks, state.direction == FORWARD
    low, high = (1, 3) if forward else (5, 7)
    shortest, longest = limit.period_min_ticks, limit.watch_ticks
    last = min(last, state.voids - 1) - delay
    room = min(limit.window_pulses - state.window_n, (a.size - 1 - at_a) // 2)
    room = min(room, (b.size - 1 - at_b) // 2)
    rise, boundary = state.rise - delay, state.boundary - delay
    sum_a, sum_b, T, phase, n = state.sum_a, state.sum_b, state.period, state.phase, 0
    while n < room:
        i, j = at_a + 2 * n, at_b + 2 * n
        b_first, a_fall, b_second, a_rise = b[j], a[i], b[j + 1], a[i + 1]
        next_T = a_rise - rise
        next_phase = (b_first if forward else b_second) - rise
        if not (
            (rise < b_first < a_fall < b_second < a_rise < b[j + 2] and a_rise <= last)
            and (shortest <= next_T <= longest)
            and (low * next_T <= 8 * next_phase <= high * next_T)
            and min(a_rise - a_fall, a[i + 2] - a_rise) > hold
            and min(b_second - b_first, b[j + 2] - b_second) > hold
        ):
            break
        T, phase, rise = next_T, next_phase, a_rise
        sum_a += rise - boundary
        sum_b += sum_a
        n += 1
    if n:
        state.period, state.period_valid, state.phase = T, 1, phase
        state.phase_direction, state.faults = state.direction, 0
        state.armed, state.run_a, state.run_b = 1, 1, 0
        state.rise = state.edge = state.either = rise + delay
        state.expires = state.rise + limit.period_max
        state.position += 4 * n if forward else -4 * n
        state.pulses += n
        state.a_rising += n
        state.b_rising += n
        state.window_n += n
        state.sum_a, state.sum_b = sum_a, sum_b
    return at_a + 2 * n, at_b + 2 * n


@njit(cache=True, nogil=True)
def run(
    limit_of: Any,
    state_of: Any,
    pins: tuple[Ticks, Ticks],
    strobes: Ticks,
    rows: Any,
    first: int,
    origin: int,
    end: int,
) -> tuple[int, int]:
    """Take every event of a sensor in ticks below `end`; returns how many pin changes it used up.

    limit_of, state_of: shape (1,), LIMITS and SENSOR. pins: the ticks at which a, b change, not
    yet used up. strobes: the gates' ticks; their snapshots go into rows[first:], SNAPSHOT.
    """
    limit, state = limit_of[0], state_of[0]
    a, b = pins
    at_a = at_b = at_gate = 0
    while True:
        tick_a, glitch_a = event(a, at_a, limit)
        tick_b, glitch_b = event(b, at_b, limit)
        gate = strobes[at_gate] if at_gate < strobes.size else FAR
        tick = min(min(tick_a, tick_b), min(gate, min(state.expires, state.voids)))
        if tick >= end:
            return at_a, at_b
        if tick == state.expires:
            state.flags |= SATURATED
            state.expires = FAR
        if tick == state.voids:
            state.flags |= SATURATED
            void(state)
        is_a, is_b, rose = tick_a == tick, tick_b == tick, False
        if (is_a and glitch_a) or (is_b and glitch_b):
            state.rejected_glitches += int(is_a and glitch_a) + int(is_b and glitch_b)
            state.flags |= GLITCH
        at_a += (2 if glitch_a else 1) if is_a else 0
        at_b += (2 if glitch_b else 1) if is_b else 0
        edge_a, edge_b = is_a and not glitch_a, is_b and not glitch_b
        if edge_a or edge_b:
            rose = take_edges(state, limit, edge_a, edge_b, tick)
        if gate == tick:
            latch(state, limit, rows[first + at_gate], origin, tick)
            at_gate += 1
            gate = strobes[at_gate] if at_gate < strobes.size else FAR
        if rose and state.direction != NONE:
            at_a, at_b = stride(state, limit, a, at_a, b, at_b, min(gate, end - 1))


@njit(cache=True, nogil=True)
def edges(limit_of: Any, state_of: Any, pins: tuple[Ticks, Ticks], end: int) -> tuple[Ticks, Ticks]:
    """Every tick below `end` with an edge, and the levels after it, a + 2·b (ODO-13).

    Arguments as of `run`, which has not yet used them.
    """
    limit, (a, b) = limit_of[0], pins
    level = state_of[0].level_a | state_of[0].level_b << 1
    ticks, levels = np.empty(a.size + b.size, np.int64), np.empty(a.size + b.size, np.int64)
    at_a = at_b = n = 0
    while True:
        tick_a, glitch_a = event(a, at_a, limit)
        tick_b, glitch_b = event(b, at_b, limit)
        tick = min(tick_a, tick_b)
        if tick >= end:
            return ticks[:n], levels[:n]
        is_a, is_b = tick_a == tick, tick_b == tick
        at_a += (2 if glitch_a else 1) if is_a else 0
        at_b += (2 if glitch_b else 1) if is_b else 0
        change = int(is_a and not glitch_a) | int(is_b and not glitch_b) << 1
        if change:
            level ^= change
            ticks[n], levels[n] = tick, level
            n += 1
