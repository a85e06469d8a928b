"""The relays: step functions and gateware are the same, and what they do is DRV-13's."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railgate.vital_output.plant.edges import Edges
from railgate.vital_output.plant.relay import RelayTimes, Stage, contacts
from railgate.vital_output.spec import Config
from railgate.waves import Trace, Waveform
from vital_output.plant.stimuli import (
    FAST,
    TIMES,
    plant_clocks,
    relay_runs,
    through,
    trace,
)
from vital_output.small import SMALL

CLOCK = plant_clocks(TIMES)[2]
EDGES = Edges(CLOCK)
PERIOD, PICK_UP, RELEASE = 20, 100, 70


def assert_same_contact(kind: str, times: RelayTimes, run: Trace) -> None:
    expected = contacts(SMALL, times, plant_clocks(times)[2], run)
    found = through(kind, times, run)["contact"]
    difference = expected.first_difference(found)
    assert difference is None, f"steps and {kind} part at {difference}"


@pytest.mark.parametrize("times", [TIMES, FAST])
@given(data=st.data())
@settings(max_examples=100, deadline=None)
def test_the_contacts_are_those_of_cxxrtl(times: RelayTimes, data: st.DataObject) -> None:
    assert_same_contact("cxxrtl", times, data.draw(relay_runs(times)))


@pytest.mark.parametrize("times", [TIMES, FAST])
@given(data=st.data())
@settings(max_examples=5, deadline=None)
def test_the_contacts_are_those_of_pysim(times: RelayTimes, data: st.DataObject) -> None:
    assert_same_contact("pysim", times, data.draw(relay_runs(times)))


def pulses(first: int, last: int, period: int = PERIOD, output: int = 0) -> Waveform:
    """A train in relay ticks: rises in `first`, `first` + period, … below `last`."""
    rises = np.arange(first, last, period)
    ticks = np.stack([rises, rises + period // 2], axis=1).ravel()
    values = np.arange(1, 1 + ticks.size) % 2 << output
    return EDGES.wave(np.append(0, ticks), np.append(0, values), SMALL.outputs, 10**15)


def closed(
    pulses_1: Waveform, pulses_2: Waveform, ticks: int, **defects: Waveform
) -> list[tuple[int, int]]:
    """When the contacts change, in relay ticks, and to what."""
    end = int(EDGES.begin(ticks))
    signals = {"fpga_1.pulses": pulses_1, "fpga_2.pulses": pulses_2}
    signals |= {f"relay.{name}": wave for name, wave in defects.items()}
    whole = {name: wave.slice(0, end) for name, wave in signals.items()}
    run = trace(whole, end)
    assert_same_contact("cxxrtl", TIMES, run)
    found = contacts(SMALL, TIMES, CLOCK, run)
    return list(zip(EDGES.during(found.ticks).tolist(), found.values.tolist(), strict=True))[1:]


def held(first: int, last: int, output: int = 0) -> Waveform:
    """A defect of an output in these relay ticks."""
    return EDGES.wave([0, first, last], [0, 1 << output, 0], SMALL.outputs, 10**15)


NONE = Waveform.of([0], [0], SMALL.outputs)
EVER = Waveform.of([0], [3], SMALL.outputs)


@pytest.mark.shows("DRV-13")
def test_both_trains_close_the_contact_and_the_end_of_one_opens_it() -> None:
    """A pulse of tick k is new behind the flip-flops in k + 2; the second rise makes it alive."""
    found = closed(pulses(10, 210), pulses(13, 810), 1000)
    alive = 13 + 2 + PERIOD + 1
    last = 190 + 2
    dead = last + 22 + 1
    assert found == [(alive + PICK_UP, 1), (dead + RELEASE, 0)]


def test_each_output_has_a_relay_of_its_own() -> None:
    assert closed(pulses(10, 900, output=1), pulses(13, 900, output=1), 300) == [(136, 2)]
    assert closed(pulses(10, 900, output=1), pulses(13, 900, output=0), 900) == []


@pytest.mark.shows("DRV-13")
@pytest.mark.parametrize(
    ("one", "other"),
    [
        (pulses(10, 900), NONE),
        (pulses(10, 900), EVER),
        (EVER, EVER),
        (pulses(10, 900), pulses(10, 900, 17)),
        (pulses(10, 900), pulses(10, 900, 23)),
        (pulses(10, 900), pulses(10, 900, 2 * PERIOD)),
        (pulses(10, 900), pulses(10, 900, PERIOD // 2)),
    ],
)
def test_a_level_or_another_frequency_never_closes_it(one: Waveform, other: Waveform) -> None:
    assert closed(one, other, 900) == []
    assert closed(other, one, 900) == []


@pytest.mark.shows("DRV-13")
@pytest.mark.parametrize("period", [18, 19, 21, 22])
def test_a_period_within_the_tolerance_closes_it(period: int) -> None:
    assert len(closed(pulses(10, 900, period), pulses(10, 900), 900)) == 1


def test_a_shorter_break_than_the_release_leaves_it_closed() -> None:
    def again(pause: int) -> Waveform:
        first, then = pulses(10, 210), pulses(190 + pause, 900)
        ticks = np.append(first.ticks, then.ticks[1:])
        return Waveform.of(ticks, np.append(first.values, then.values[1:]), SMALL.outputs)

    # Alive again one period after the first new rise, RELEASE ticks after it was dead.
    longest = 22 + RELEASE - PERIOD
    assert len(closed(again(longest - 1), pulses(10, 900), 880)) == 1
    assert [value for _, value in closed(again(longest), pulses(10, 900), 880)] == [1, 0, 1]


@pytest.mark.shows("DRV-13")
def test_a_train_that_ends_before_the_pick_up_closes_nothing() -> None:
    assert closed(pulses(10, 10 + 5 * PERIOD), pulses(10, 900), 900) == []


def test_welded_keeps_it_closed_for_just_so_long_and_closes_nothing() -> None:
    short, long = pulses(10, 210), pulses(10, 900)
    assert closed(short, long, 600, welded=held(0, 400)) == [(133, 1), (401, 0)]
    for until, opens in ((250, 285), (284, 285), (285, 286), (286, 287)):
        assert closed(short, long, 600, welded=held(0, until)) == [(133, 1), (opens, 0)]
    assert closed(short, long, 600, welded=held(0, 400, output=1)) == [(133, 1), (285, 0)]
    assert closed(NONE, NONE, 600, welded=EVER) == []


def test_without_current_in_the_coil_it_is_open() -> None:
    both = pulses(10, 900)
    assert closed(both, both, 800, broken=EVER) == []
    assert closed(both, both, 800, broken=held(300, 600)) == [
        (133, 1),
        (300 + RELEASE, 0),
        (600 + PICK_UP, 1),
    ]


@pytest.mark.shows("DRV-13")
def test_a_rogue_train_counts_as_the_fpgas_and_needs_the_other() -> None:
    assert closed(NONE, NONE, 800, rogue_1=EVER) == []
    assert closed(NONE, pulses(10, 900), 800, rogue_1=EVER) == [(133, 1)]
    assert closed(NONE, NONE, 300, rogue_1=EVER, rogue_2=EVER) == [(2 + PERIOD + 1 + PICK_UP, 3)]


def test_after_a_reset_all_is_as_at_start() -> None:
    both = pulses(10, 900)
    at = int(EDGES.begin(400))
    rst = EDGES.wave([0, 400, 401], [0, 1, 0], 1, 10**15)
    end = int(EDGES.begin(600))
    run = {"fpga_1.pulses": both, "fpga_2.pulses": both, "relay_rst": rst}
    found = through("cxxrtl", TIMES, trace({k: w.slice(0, end) for k, w in run.items()}, end))
    ticks = EDGES.during(found["contact"].ticks).tolist()
    # Tick 401 is tick 0; the next rises of the pulses are in 410 and 430.
    assert ticks == [0, 133, 401, 430 + 2 + 1 + PICK_UP]
    assert at < found["contact"].ticks[-1]


def test_the_stage_is_built_for_the_train() -> None:
    assert Stage.of(SMALL, TIMES) == Stage(20, 18, 22)
    assert Stage.of(Config(), RelayTimes()) == Stage(1000, 900, 1100)
    odd = Config(pulse_hz=3000, pulse_tolerance=Fraction(1, 100))
    assert Stage.of(odd, RelayTimes()) == Stage(333, 330, 336)


def test_ticks_of_the_relay_are_whole_and_at_least_one() -> None:
    assert (TIMES.pick_up_ticks, TIMES.release_ticks) == (PICK_UP, RELEASE)
    assert (FAST.pick_up_ticks, FAST.release_ticks) == (1, 17)


def test_what_is_no_relay_is_refused() -> None:
    with pytest.raises(ValueError, match="clock_hz must be between 1000 and 1000000000, not 10"):
        RelayTimes(clock_hz=10)
    with pytest.raises(ValueError, match="release_s must be above 0 and at most 10 s, not 0"):
        RelayTimes(release_s=Fraction(0))
    with pytest.raises(ValueError, match="must be at least 8 times that of the pulse train, 5000"):
        Stage.of(SMALL, RelayTimes(clock_hz=35_000))
    late = trace({"fpga_1.pulses": NONE, "fpga_2.pulses": NONE}, 100).shift(1)
    with pytest.raises(ValueError, match="the pulses must begin in tick 0, not 1"):
        contacts(SMALL, TIMES, CLOCK, late)
