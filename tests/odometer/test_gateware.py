"""The odometer's gateware against the sentences of its contract, tick by tick."""

from fractions import Fraction
from functools import cache
from itertools import accumulate, pairwise, product

import pytest
from amaranth.back import rtlil
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.engines.ports import ports
from railgate.engines.pysim import PySim
from railgate.odometer.design import design
from railgate.odometer.gateware import Odometer
from railgate.odometer.spec import STATE, Config, Direction, Flag
from railgate.waves import Trace, Waveform

# A tick of 50 µs: overspeed below 12 ticks, supervised up to 246, saturated at 1023.
SMALL = {
    "clock_hz": 20_000,
    "sensors": 1,
    "overspeed_kmh": Fraction(60),
    "minimum_kmh": Fraction(3),
    "period_bits": 10,
    "count_bits": 16,
    "window_pulses": 200,
}
LATENCY = Config.snapshot_latency_ticks


def config(**changes):
    return Config(**{**SMALL, **changes})


@cache
def opened(config):
    engine = PySim(design(config))
    return engine, engine.checkpoint()


def levels(toggles, initial=0):
    ticks = [0, *toggles]
    return Waveform.of(ticks, [(initial + i) % 2 for i in range(len(ticks))])


def pulses(ticks):
    """One tick high at each."""
    edges = sorted({t for tick in ticks for t in (tick, tick + 1)})
    return Waveform.of([0, *edges], [0, *(int(t in set(ticks)) for t in edges)])


def trace(config, end, **signals):
    """Signals by name with `_` for `.`, so `sensor_0_a`."""
    named = {name.replace("_", "."): wave.slice(0, end) for name, wave in signals.items()}
    return Trace(named, design(config).period, 0, end)


def run(config, end, strobe=(), a=(), b=(), initial=(0, 0), **more):
    """What sensor 0 answers to toggles whose *edges* are in the ticks `a` and `b`."""
    delay = config.input_delay_ticks
    pins = [
        levels([tick - delay for tick in toggles], level)
        for toggles, level in zip((a, b), initial, strict=True)
    ]
    stimulus = trace(
        config, end, sensor_0_a=pins[0], sensor_0_b=pins[1], strobe=pulses(strobe), **more
    )
    engine, start = opened(config)
    engine.restore(start)
    return engine.advance(end, stimulus)


def snapshots(result, sensor=0):
    """The fields of each snapshot, by name."""
    names = [name for name in result.signals if name.startswith(f"sensor.{sensor}.")]
    return [
        {name.split(".")[-1]: int(result[name].at(tick)) for name in (*names, "number", "time")}
        for tick in result["number"].ticks[1:]
    ]


def snapshot(*args, **kwargs):
    """The one snapshot of a run."""
    (one,) = snapshots(run(*args, **kwargs))
    return one


def forward(start, period, count):
    """Toggles of a and b over whole periods, a rising first at `start`."""
    quarters = [start + period * i // 4 for i in range(4 * count)]
    return quarters[0::2], quarters[1::2]


def flags(*names):
    return sum(names, Flag(0))


gaps = st.lists(st.integers(1, 40), min_size=1, max_size=60)
reads = st.lists(st.integers(LATENCY, 120), min_size=1, max_size=8)


@pytest.mark.shows("ODO-2")
@settings(max_examples=15, deadline=None)
@given(st.lists(st.integers(LATENCY, 300), min_size=2, max_size=12), st.integers(4, 20))
def test_successive_periods_add_up_to_exactly_the_elapsed_ticks(periods, start):
    rises = list(accumulate(periods, initial=start))
    falls = [rise + 5 for rise in rises]
    toggles = sorted(rises + falls)
    seen = snapshots(run(config(), rises[-1] + 40, strobe=rises, a=toggles))
    assert [one["period"] for one in seen] == [0, *periods]
    assert sum(one["period"] for one in seen) == rises[-1] - rises[0]


@pytest.mark.shows("ODO-6")
@settings(max_examples=25, deadline=None)
@given(gaps, reads)
def test_no_pulse_is_lost_or_counted_twice_for_any_alignment_of_edges_and_reads(gaps, reads):
    toggles = list(accumulate(gaps, initial=4))
    rises = toggles[::2]
    strobes = list(accumulate(reads))
    seen = snapshots(run(config(), strobes[-1] + LATENCY + 1, strobe=strobes, a=toggles))
    assert [one["time"] for one in seen] == strobes
    for before, one in pairwise([{"time": -1, "a_rising": 0}, *seen]):
        assert one["pulses"] == sum(before["time"] < rise <= one["time"] for rise in rises)
        assert one["a_rising"] - before["a_rising"] == one["pulses"]


@pytest.mark.shows("ODO-6")
def test_a_read_in_the_very_tick_of_an_edge_counts_it_once():
    for strobe in range(48, 53):
        seen = snapshots(run(config(), 120, strobe=(strobe, 80), a=[50, 60]))
        assert [one["pulses"] for one in seen] == ([1, 0] if strobe >= 50 else [0, 1])


@pytest.mark.shows("ODO-2", "ODO-4", "ODO-7", "ODO-10")
@settings(max_examples=25, deadline=None)
@given(st.lists(st.integers(1, 60), min_size=1, max_size=60), reads)
def test_every_field_belongs_to_the_tick_of_the_strobe(gaps, reads):
    """Forward only; each field by its definition from the list of edges up to the strobe."""
    small = config()
    edges = list(accumulate(gaps, initial=4))
    a, b = edges[0::2], edges[1::2]
    strobes = list(accumulate(reads))
    result = run(small, strobes[-1] + LATENCY + 1, strobe=strobes, a=a, b=b)
    boundary = None
    for number, one in enumerate(snapshots(result), 1):
        s = one["time"]
        rises = [tick for tick in a[0::2] if tick <= s]
        b_rises = [tick for tick in b[0::2] if tick <= s]
        steps = [tick for tick in edges if tick <= s]
        assert one["number"] == number
        assert one["position"] == len(steps)
        assert (one["a_rising"], one["b_rising"]) == (len(rises), len(b_rises))
        assert one["since_edge"] == s - (steps[-1] if steps else 0)
        assert one["since_rise"] == s - (rises[-1] if rises else 0)
        assert one["level_a"] == sum(tick <= s for tick in a) % 2
        assert one["level_b"] == sum(tick <= s for tick in b) % 2
        assert one["direction"] == (Direction.FORWARD if steps else Direction.NONE)
        if len(rises) > 1:
            T = rises[-1] - rises[-2]
            phase = next(tick for tick in b_rises if tick > rises[-2]) - rises[-2]
            ahead = Direction.FORWARD if T <= 8 * phase <= 3 * T else Direction.NONE
            back = Direction.REVERSE if 5 * T <= 8 * phase <= 7 * T else Direction.NONE
            assert (one["period"], one["phase"], one["period_valid"]) == (T, phase, 1)
            assert one["phase_direction"] == ahead | back
        if rises and boundary is None:
            boundary = rises[0]
        times = [tick - boundary for tick in rises if tick > boundary] if rises else []
        assert one["window_seated"] == bool(rises)
        assert one["window_n"] == len(times)
        assert one["window_ticks"] == (times[-1] if times else 0)
        assert one["sum_a"] == sum(times)
        assert one["sum_b"] == sum(accumulate(times))
        boundary = rises[-1] if rises else None


@pytest.mark.shows("ODO-7")
def test_all_fields_change_together_and_stay_until_the_next_snapshot():
    a, b = forward(10, 40, 12)
    result = run(config(), 400, strobe=(100, 250), a=a, b=b)
    changes = {
        int(tick)
        for name, wave in result.signals.items()
        for tick in wave.ticks[1:]
        if name != "busy"
    }
    assert changes == {100 + LATENCY, 250 + LATENCY}
    busy = [0, 101, 100 + LATENCY, 251, 250 + LATENCY]
    assert result["busy"] == Waveform.of(busy, [0, 1, 0, 1, 0])
    assert all(wave.values[0] == 0 for wave in result.signals.values())


@pytest.mark.shows("ODO-7")
def test_a_strobe_while_busy_joins_the_gate_under_way():
    a, b = forward(10, 20, 30)
    alone = run(config(), 400, strobe=(100, 100 + LATENCY), a=a, b=b)
    joined = run(config(), 400, strobe=range(100, 101 + LATENCY), a=a, b=b)
    assert joined == alone
    assert [one["time"] for one in snapshots(joined)] == [100, 100 + LATENCY]


@pytest.mark.shows("ODO-6", "ODO-7")
def test_the_counts_are_cumulative_so_that_a_lost_reply_loses_nothing():
    a, b = forward(10, 20, 12)
    first, last = snapshots(run(config(), 400, strobe=(100, 300), a=a, b=b))
    assert first["pulses"] + last["pulses"] == last["a_rising"] == 12
    assert last["b_rising"] == 12
    assert last["position"] == 4 * 12


@pytest.mark.shows("ODO-9")
@pytest.mark.parametrize("filter_ticks", [0, 1, 3])
def test_the_filter_rejects_what_is_too_short_and_counts_it(filter_ticks):
    filtered = config(filter_ticks=filter_ticks)
    for length, lag in product(range(1, 7), (0, 1)):
        b = (20 + lag, 20 + lag + length)
        one = snapshot(filtered, 120, strobe=(60,), a=(20, 20 + length), b=b)
        passes = length > filter_ticks
        assert one["a_rising"] == one["b_rising"] == passes
        assert one["rejected_glitches"] == (0 if passes else 2)
        assert bool(one["flags"] & Flag.GLITCH) == (not passes)


@pytest.mark.shows("ODO-9")
def test_the_filter_leaves_period_and_phase_unchanged():
    for filter_ticks in (0, 5):
        filtered = config(filter_ticks=filter_ticks)
        one = snapshot(filtered, 250, strobe=(200,), a=(20, 40, 65, 90), b=(31, 52, 80, 100))
        assert (one["period"], one["phase"], one["since_rise"]) == (45, 11, 200 - 65)


@pytest.mark.shows("ODO-5", "ODO-6")
def test_forward_and_reverse_are_told_by_phase_and_steps():
    leads, lags = forward(20, 40, 4)
    ahead = snapshot(config(), 300, strobe=(250,), a=leads, b=lags)
    back = snapshot(config(), 300, strobe=(250,), a=lags, b=leads)
    assert (ahead["direction"], ahead["phase_direction"]) == (Direction.FORWARD,) * 2
    assert (back["direction"], back["phase_direction"]) == (Direction.REVERSE,) * 2
    assert (ahead["position"], back["position"]) == (16, -16)
    assert ahead["flags"] == back["flags"] == 0
    assert (ahead["phase"], back["phase"]) == (10, 30)


@pytest.mark.shows("ODO-4")
def test_the_phase_ends_at_the_first_later_rise_of_b_in_the_period():
    a = [20, 40, 100]
    for b, phase in (
        ([30, 50, 60, 70], 10),  # of two, the first
        ([20, 30, 60, 70], 40),  # with the opening edge: a later one
        ([15, 25], 0),  # before it: none
        ([10, 25, 100], 0),  # with the closing edge: none
    ):
        one = snapshot(config(), 200, strobe=(150,), a=a, b=b)
        assert (one["period"], one["phase"]) == (80, phase)


@pytest.mark.shows("ODO-5", "ODO-6", "ODO-10")
def test_a_reversal_yields_no_phantom_period_and_voids_the_window():
    # Forward over three rises of a, then back over the last and, much later, forward again.
    a = [20, 40, 60, 80, 100, 130, 400]
    b = [30, 50, 70, 90, 410]
    rocking, after = snapshots(run(config(), 500, strobe=(145, 430), a=a, b=b))
    assert rocking["direction_changes"] == 1
    assert rocking["flags"] == flags(Flag.REVERSAL, Flag.WINDOW_VOID)
    assert (rocking["period_valid"], rocking["direction"]) == (1, Direction.REVERSE)
    assert (rocking["window_seated"], rocking["window_n"], rocking["sum_a"]) == (0, 0, 0)
    assert rocking["position"] == 8
    assert (after["period"], after["period_valid"]) == (300, 0)
    assert after["phase_direction"] == Direction.NONE
    assert after["direction_changes"] == 2
    assert (after["window_seated"], after["window_n"]) == (1, 0)
    assert after["position"] == 10
    assert after["flags"] == flags(Flag.REVERSAL)


@pytest.mark.shows("ODO-12")
def test_both_edges_in_one_tick_are_illegal_and_leave_the_position():
    one = snapshot(config(), 200, strobe=(150,), a=[20, 40, 60], b=[30, 50, 60])
    assert one["flags"] == flags(Flag.ILLEGAL, Flag.WINDOW_VOID)
    assert (one["illegal_transitions"], one["position"]) == (1, 4)
    assert (one["direction"], one["period_valid"]) == (Direction.NONE, 0)
    assert (one["a_rising"], one["b_rising"]) == (2, 2)
    assert one["window_seated"] == 1


@pytest.mark.shows("ODO-5")
def test_a_step_after_an_illegal_transition_is_no_reversal():
    one = snapshot(config(), 200, strobe=(150,), a=[20, 60], b=[30, 60, 80])
    assert (one["direction"], one["direction_changes"]) == (Direction.REVERSE, 0)
    assert one["flags"] & Flag.REVERSAL == 0


@pytest.mark.shows("ODO-10")
def test_windows_share_their_boundary_edge():
    a, b = forward(20, 37, 12)
    seen = snapshots(run(config(), 500, strobe=(100, 220, 400), a=a, b=b))
    rises = [tick for tick in a[0::2] if tick <= 400]
    assert sum(one["window_n"] for one in seen) == len(rises) - 1
    assert sum(one["window_ticks"] for one in seen) == rises[-1] - rises[0]


@pytest.mark.shows("ODO-10")
def test_an_edge_beside_the_strobe_belongs_to_one_window_only():
    a, b = forward(20, 40, 8)
    for strobe in range(177, 184):  # around the rise in tick 180
        before = [tick - 20 for tick in range(60, 181, 40) if tick <= strobe]
        last = max(20 + tick for tick in before)
        after = [tick - last for tick in range(180, 301, 40) if tick > last]
        seen = snapshots(run(config(), 340, strobe=(strobe, 310), a=a, b=b))
        for one, times in zip(seen, (before, after), strict=True):
            assert (one["window_n"], one["window_ticks"]) == (len(times), times[-1])
            assert (one["sum_a"], one["sum_b"]) == (sum(times), sum(accumulate(times)))


@pytest.mark.shows("ODO-10")
def test_a_window_without_an_edge_keeps_its_boundary():
    a, b = forward(20, 80, 2)
    seen = snapshots(run(config(), 300, strobe=(40, 80, 250), a=a, b=b))
    assert [(one["window_seated"], one["window_n"]) for one in seen] == [(1, 0), (1, 0), (1, 1)]
    assert seen[-1]["window_ticks"] == 80


@pytest.mark.shows("ODO-10")
def test_a_window_of_too_many_periods_is_voided_and_seated_anew():
    short = config(window_pulses=3)
    a, b = forward(20, 40, 6)
    full, over = (
        snapshot(short, 400, strobe=(tick,), a=a, b=b) for tick in (a[0::2][3], a[0::2][4])
    )
    assert (full["window_n"], full["flags"]) == (3, 0)
    assert (over["window_seated"], over["window_n"], over["sum_b"]) == (1, 0, 0)
    assert over["flags"] == flags(Flag.WINDOW_OVERFLOW, Flag.WINDOW_VOID)


@pytest.mark.shows("ODO-10")
def test_a_window_longer_than_its_counter_is_voided_in_that_very_tick():
    small = config()
    full = 20 + small.period_max
    a, b = forward(20, 200, 8)
    before, at = (snapshot(small, 1200, strobe=(tick,), a=a, b=b) for tick in (full - 1, full))
    assert (before["window_seated"], before["window_n"], before["flags"]) == (1, 5, 0)
    assert (at["window_seated"], at["window_n"], at["sum_a"]) == (0, 0, 0)
    assert at["flags"] == flags(Flag.SATURATED, Flag.WINDOW_VOID)


@pytest.mark.shows("ODO-2", "ODO-11", "ODO-12")
def test_a_period_saturates_and_never_wraps():
    small = config()
    top = small.period_max
    for T in (top - 1, top, top + 1, 2 * top + 5):
        one = snapshot(small, 2300, strobe=(T + 20,), a=[20, 30, 20 + T], b=[25, 35])
        assert one["period"] == min(T, top)
        assert one["period_valid"] == (top > T)
        assert bool(one["flags"] & Flag.SATURATED) == (top <= T)
    still = snapshots(run(small, 3000, strobe=(1500, 2900), a=[20]))
    assert [one["since_rise"] for one in still] == [top, top]
    assert [one["since_edge"] for one in still] == [top, top]
    saturated = [bool(one["flags"] & Flag.SATURATED) for one in still]
    assert saturated == [True, False]  # told once


@pytest.mark.shows("ODO-12")
def test_the_pulse_count_stays_at_its_greatest_value():
    small = config(count_bits=8)
    engine, start = opened(small)
    engine.restore(start)
    engine.poke("sensor_0.pulses", 254)
    a = trace(small, 100, sensor_0_a=levels([10, 15, 20, 25]), strobe=pulses([18, 40]))
    engine.poke("sensor_0.a_rising", 254)
    one, two = snapshots(engine.advance(100, a))
    assert (one["pulses"], one["a_rising"], one["flags"] & Flag.SATURATED) == (255, 255, 0)
    assert (two["pulses"], two["a_rising"]) == (1, 0)
    engine.restore(start)
    engine.poke("sensor_0.pulses", 255)
    one, _ = snapshots(engine.advance(100, a))
    assert (one["pulses"], one["flags"] & Flag.SATURATED) == (255, Flag.SATURATED)


@pytest.mark.shows("ODO-12")
@pytest.mark.parametrize("gone", ["a", "b"])
def test_a_missing_channel_is_told_after_so_many_pulses_of_the_other(gone):
    small = config(missing_pulses=5)
    other = {"a": "b", "b": "a"}[gone]
    toggles = [20 + 20 * i for i in range(14)]
    flag = Flag.A_MISSING if gone == "a" else Flag.B_MISSING
    seen = snapshots(run(small, 400, strobe=(179, 260), **{other: toggles}))
    assert [one["flags"] & flag for one in seen] == [0, flag]
    assert seen[1]["flags"] & (Flag.A_MISSING | Flag.B_MISSING) == flag


@pytest.mark.shows("ODO-12")
def test_one_lost_pulse_at_speed_is_a_mismatch():
    a, b = forward(20, 40, 8)
    assert snapshot(config(), 500, strobe=(400,), a=a, b=b)["flags"] == 0
    lost = snapshot(config(), 500, strobe=(400,), a=a, b=b[:8] + b[10:])
    assert lost["flags"] & Flag.MISMATCH
    assert not lost["flags"] & (Flag.A_MISSING | Flag.B_MISSING)


@pytest.mark.shows("ODO-12")
def test_rocking_at_standstill_is_no_mismatch():
    small = config(missing_pulses=5)
    slow = small.watch_ticks + 1
    rocking = [20 + slow * i + fall for i in range(7) for fall in (0, 5)]
    one = snapshot(small, rocking[-1] + 60, strobe=(rocking[-1] + 20,), a=rocking)
    assert one["a_rising"] == 7
    assert not one["flags"] & (Flag.MISMATCH | Flag.B_MISSING)


@pytest.mark.shows("ODO-12")
def test_a_pause_disarms_the_watch_over_both_channels():
    small = config()
    a, b = [20, 40, 60, 80, 100, 120], [30, 50, 70, 90, 110, 115]
    for pause in (small.watch_ticks, small.watch_ticks + 1):
        # The last rise before the pause is one of b. It turns then, so that no period judges.
        again = 110 + pause
        toggles = [*a, again, again + 5, again + 10]
        one = snapshot(small, 700, strobe=(600,), a=toggles, b=b)
        assert bool(one["flags"] & Flag.MISMATCH) == (pause == small.watch_ticks)


@pytest.mark.shows("ODO-5", "ODO-12")
def test_a_phase_fault_is_told_only_after_so_many_bad_periods():
    small = config(phase_fault_periods=3)
    rises = [20 + 40 * i for i in range(9)]
    a = sorted(rises + [tick + 20 for tick in rises])
    bad = sorted([tick + 19 for tick in rises] + [tick + 39 for tick in rises])  # 171°

    def told(b, tick):
        return bool(snapshot(small, 500, strobe=(tick,), a=a, b=b)["flags"] & Flag.PHASE_FAULT)

    assert not told(bad, rises[3] - 1)
    assert told(bad, rises[3])
    good = [tick + 10 for tick in (rises[2], rises[2] + 20)]
    mended = sorted([*bad[:4], *good, *bad[6:]])  # the third period is a good one
    assert not told(mended, rises[6] - 1)
    assert told(mended, rises[6])


@pytest.mark.shows("ODO-5")
def test_the_phase_is_not_judged_below_the_minimum_speed():
    small = config(phase_fault_periods=1)
    for T in (small.watch_ticks, small.watch_ticks + 1):
        one = snapshot(small, 600, strobe=(500,), a=[20, 22, 20 + T], b=[21, 23])
        assert one["period_valid"] == 1
        assert bool(one["flags"] & Flag.PHASE_FAULT) == (small.watch_ticks >= T)


@pytest.mark.shows("ODO-12")
def test_overspeed_is_a_period_below_the_shortest():
    small = config()
    for T in (small.period_min_ticks - 1, small.period_min_ticks):
        one = snapshot(small, 200, strobe=(100,), a=[20, 25, 20 + T, 25 + T], b=[22, 27])
        assert bool(one["flags"] & Flag.OVERSPEED) == (small.period_min_ticks > T)


@pytest.mark.shows("ODO-12")
def test_rocking_over_an_edge_of_a_is_no_overspeed():
    rocking = snapshot(config(), 200, strobe=(100,), a=[20, 25, 28, 33, 36, 41], b=[])
    assert rocking["a_rising"] == 3
    assert not rocking["flags"] & Flag.OVERSPEED


def stamps(result):
    """(tick offered, ticks, a, b, lost) of each stamp taken where ready is always 1."""
    valid, payload = result["sensor.0.stamps.valid"], result["sensor.0.stamps.payload"]
    offered = [tick for tick in range(result.end) if valid.at(tick)]
    words = [int(payload.at(tick)) for tick in offered]
    return [
        (tick, w & 0xFFFFFFFF, w >> 32 & 1, w >> 33 & 1, w >> 34)
        for tick, w in zip(offered, words, strict=True)
    ]


@pytest.mark.shows("ODO-13")
@pytest.mark.parametrize("depth", [4, 5])
def test_each_edge_is_stamped_in_order_and_offered_after_the_latency(depth):
    stamped = config(stamp_depth=depth)
    ready = Waveform.of([0], [1])
    result = run(stamped, 100, a=[20, 21, 22, 40], b=[21, 30, 41], sensor_0_stamps_ready=ready)
    delay = stamped.stamp_latency_ticks
    edges = [(20, 1, 0), (21, 0, 1), (22, 1, 1), (30, 1, 0), (40, 0, 0), (41, 0, 1)]
    assert stamps(result) == [(t + delay, t, a, b, 0) for t, a, b in edges]
    idle = result["sensor.0.stamps.valid"].falling()
    assert idle.size
    assert not result["sensor.0.stamps.payload"].at(idle).any()


@pytest.mark.shows("ODO-13")
@pytest.mark.parametrize("depth", [1, 2, 3])
def test_as_many_edges_in_successive_ticks_as_the_fifo_holds_are_all_stamped(depth):
    a = list(range(20, 20 + depth))
    ready = Waveform.of([0], [1])
    stamped = config(stamp_depth=depth)
    result = run(stamped, 80, strobe=(50,), a=a, sensor_0_stamps_ready=ready)
    assert [stamp[:2] for stamp in stamps(result)] == [(tick + 4, tick) for tick in a]
    (one,) = snapshots(result)
    assert one["flags"] & Flag.STAMP_OVERFLOW == 0


@pytest.mark.shows("ODO-13")
def test_a_full_fifo_drops_the_newest_tells_it_and_marks_the_next_one():
    for depth in (1, 2, 3):
        stamped = config(stamp_depth=depth)
        a = [20 + 10 * i for i in range(6)]  # the FIFO is emptied from tick 65 on
        result = run(
            stamped,
            150,
            strobe=(59, 120),
            a=a,
            sensor_0_stamps_ready=Waveform.of([0, 65], [0, 1]),
        )
        taken = [stamp for stamp in stamps(result) if stamp[0] >= 65]
        assert [stamp[1] for stamp in taken] == [*a[:depth], 70]
        assert [stamp[4] for stamp in taken] == [0] * depth + [1]
        seen = [one["flags"] & Flag.STAMP_OVERFLOW for one in snapshots(result)]
        assert seen == [Flag.STAMP_OVERFLOW] * 2


@pytest.mark.shows("ODO-13")
def test_an_entry_taken_makes_room_from_the_next_tick_on():
    stamped = config(stamp_depth=1)
    for edge in (40, 41):  # the first entry is taken in tick 40
        result = run(
            stamped,
            100,
            strobe=(60,),
            a=[20, edge],
            sensor_0_stamps_ready=Waveform.of([0, 40], [0, 1]),
        )
        (one,) = snapshots(result)
        assert bool(one["flags"] & Flag.STAMP_OVERFLOW) == (edge == 40)


@pytest.mark.shows("ODO-7")
def test_all_sensors_are_latched_in_the_same_tick():
    two = config(sensors=2)
    engine, start = opened(two)
    engine.restore(start)
    delay = two.input_delay_ticks
    toggles = levels([tick - delay for tick in (50, 60, 70)])
    late = levels([tick - delay for tick in (51, 61, 71)])
    stimulus = trace(two, 120, sensor_0_a=toggles, sensor_1_a=late, strobe=pulses([70]))
    result = engine.advance(120, stimulus)
    (first,), (second,) = snapshots(result, 0), snapshots(result, 1)
    assert (first["pulses"], second["pulses"]) == (2, 1)
    assert (first["since_rise"], second["since_rise"]) == (0, 19)


@pytest.mark.parametrize("filter_ticks", [0, 2])
def test_the_level_at_start_is_no_edge(filter_ticks):
    one = snapshot(config(filter_ticks=filter_ticks), 100, strobe=(50,), initial=(1, 1))
    assert (one["level_a"], one["level_b"]) == (1, 1)
    assert (one["position"], one["a_rising"], one["flags"]) == (0, 0, 0)
    assert one["since_edge"] == 50


def test_the_filtered_level_is_0_before_the_pin_has_come_through():
    for strobe in range(5):
        one = snapshot(config(), 30, strobe=(strobe,), initial=(1, 1))
        assert (one["time"], one["since_rise"]) == (strobe, strobe)
        assert one["level_a"] == one["level_b"] == (strobe >= 3)


@settings(max_examples=15, deadline=None)
@given(gaps, gaps, reads, st.integers(0, 300), st.integers(1, 3))
def test_after_a_reset_all_is_as_at_start(a_gaps, b_gaps, reads, reset, length):
    stamped = config(stamp_depth=3, filter_ticks=1)
    a, b = (levels(list(accumulate(gaps))) for gaps in (a_gaps, b_gaps))
    end = 700
    strobe = pulses(list(accumulate(reads)))
    rst = Waveform.of([0, reset, reset + length], [0, 1, 0])
    signals = {"sensor_0_a": a, "sensor_0_b": b, "strobe": strobe}
    engine, start = opened(stamped)
    engine.restore(start)
    was_reset = engine.advance(end, trace(stamped, end, rst=rst, **signals))
    begin = reset + length
    engine.restore(start)
    fresh = engine.advance(
        end - begin, trace(stamped, end, **signals).slice(begin, end).shift(-begin)
    )
    assert was_reset.slice(begin, end).shift(-begin).first_difference(fresh) is None


def test_the_registers_of_the_contract_can_be_poked():
    small = config()
    engine, start = opened(small)
    for i, name in enumerate(STATE):
        engine.restore(start)
        engine.advance(10, trace(small, 10))
        engine.poke(f"sensor_0.{name}", 100 + i)
        stimulus = trace(small, 60, strobe=pulses([20]))
        (one,) = snapshots(engine.advance(60, stimulus))
        assert one[name] == 100 + i


@pytest.mark.shows("ODO-10")
def test_the_ports_are_those_of_the_contract_and_nothing_multiplies_or_divides():
    full = Config(stamp_depth=16)
    component = Odometer(full)
    found = {port.name: (port.width, port.signed) for port in ports(component, ())}
    expected = {"strobe": (1, False), "busy": (1, False)}
    expected |= {field.name: (field.width, field.signed) for field in full.common_fields}
    for i in range(full.sensors):
        expected |= {f"sensor.{i}.{pin}": (1, False) for pin in ("a", "b")}
        expected |= {
            f"sensor.{i}.{field.name}": (field.width, field.signed) for field in full.sensor_fields
        }
        expected |= {f"sensor.{i}.stamps.{name}": (1, False) for name in ("valid", "ready")}
        expected[f"sensor.{i}.stamps.payload"] = (35, False)
    assert found == expected
    cells = rtlil.convert(component, emit_src=False)
    assert not [kind for kind in ("$mul", "$div", "$mod", "$pow") if f"cell {kind}" in cells]


@pytest.mark.shows("ODO-2", "ODO-4")
def test_the_default_configuration_measures_without_a_narrow_counter():
    """200 km/h at 16 MHz for three periods of two sensors, every width as built."""
    built = Config()
    a, b = forward(100, 2941, 3)
    engine, start = opened(built)
    engine.restore(start)
    delay = built.input_delay_ticks
    pins = {
        f"sensor_{i}_{pin}": levels([tick - delay for tick in toggles])
        for i in range(2)
        for pin, toggles in (("a", a), ("b", b))
    }
    result = engine.advance(7000, trace(built, 7000, strobe=pulses([6500]), **pins))
    for sensor in range(2):
        (one,) = snapshots(result, sensor)
        assert (one["period"], one["phase"]) == (2941, 735)
        assert (one["window_n"], one["sum_a"], one["flags"]) == (2, 3 * 2941, 0)
