"""How long an image lives, and how long a contact stays closed, after the last agreed command,
whatever fails in one channel (DRV-7, DRV-16)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from math import ceil

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from railgate.engines import open_engine
from railgate.vital_output.design import design
from railgate.vital_output.observed import Frame as Seen
from railgate.vital_output.plant.cpu import Cpus, Frame
from railgate.vital_output.plant.edges import FEMTOSECOND
from railgate.vital_output.plant.faults import FAULTS, fault
from railgate.vital_output.plant.relay import RelayTimes
from railgate.vital_output.plant.scenario import Scenario
from railgate.vital_output.plant.time import Update, updates
from railgate.vital_output.simulate import Run
from railgate.vital_output.situations import ready_s
from railgate.vital_output.spec import State
from railgate.waves import Waveform
from vital_output.pair import ENGINE, RELAY, busy, driving, entries, frames_of, inputs, run, wrong
from vital_output.random_channel import surroundings
from vital_output.scenarios import clocks, odd_clocks, scenarios
from vital_output.small import SMALL

CYCLE_TICKS, MARGIN, SLEW = SMALL.cycle_ticks, SMALL.margin_ticks, SMALL.slew_ticks
LAST_BYTE = SMALL.layout.frame_bytes - 1
"""Ticks from a frame's first byte to its last one."""

LIVE = 12
"""The cycle whose frame is the last one with an agreed 1."""

END = LIVE + SMALL.life_cycles + 3
START = int(ready_s(SMALL) / SMALL.cycle_s) + 1
TICK = 10**15 // SMALL.clock_hz
"""Femtoseconds."""


def slow_time() -> list[Update]:
    """Time that falls behind so fast that each cycle from the second on is longer by the slew."""
    each_cycle = SLEW + ceil(CYCLE_TICKS * SMALL.tolerance_ppm / 10**6)
    return [replace(each, ahead_ticks=-each_cycle * each.cycle) for each in updates(SMALL, END, 1)]


def beginnings(found: Run, fpga: int) -> dict[int, int]:
    """The tick in which each cycle begins by the FPGA's own time, by its index."""
    channel = found.channels[fpga - 1]
    index = channel.wave("index")
    ticks = channel.edges.during(index.ticks)
    return dict(zip(index.values.tolist(), ticks.tolist(), strict=True))


def ending(scenario: Scenario, sent: int) -> tuple[list[Frame], list[Frame]]:
    """Both CPUs fall silent after a frame in LIVE that is sent now."""
    one, other = (
        [replace(f, sent=sent) if f.cycle == LIVE else f for f in frames if f.cycle <= LIVE]
        for frames in frames_of(scenario, SMALL)
    )
    return one, other


def lives(found: Run, fpga: int) -> list[int]:
    """Ticks from the last byte of the last frame stored until the image is 0, each time it dies."""
    channel = found.channels[fpga - 1]
    told = []
    for at, _ in channel.counted("life_out"):
        last = max(frame.tick for stored, frame in channel.stores if stored < at)
        told.append(int(channel.edges.during(at)) - last)
    return told


def first_to_accept(scenario: Scenario, fpga: int, updates_of: Sequence[Sequence[Update]]) -> int:
    """When a frame is sent whose last byte is in the first tick in which it is acceptable."""
    plain = run(scenario, SMALL, inputs(scenario, SMALL, updates=updates_of))
    tick = beginnings(plain, fpga)[LIVE - 1] + CYCLE_TICKS - MARGIN
    return int(plain.channels[fpga - 1].edges.begin(tick - LAST_BYTE))


@pytest.mark.shows("DRV-7", kind="sweep")
@pytest.mark.parametrize("fpga", [1, 2])
def test_the_declared_bound_of_an_images_life_is_reached_to_the_tick(fpga: int) -> None:
    scenario = driving(SMALL, END - START)
    time = [slow_time(), slow_time()]
    sent = first_to_accept(scenario, fpga, time)
    for early, life in ((0, SMALL.life_bound_ticks), (1, None)):
        frames = ending(scenario, sent - early * TICK)
        found = run(scenario, SMALL, inputs(scenario, SMALL, frames=frames, updates=time))
        assert found.trace[f"fpga_{fpga}.image"].values.tolist() == [0, 1, 0]
        if life is None:  # a tick earlier it is not accepted
            assert wrong(found)[fpga - 1]["delay"] == 1
        else:
            assert lives(found, fpga) == [life]


AHEAD = st.lists(st.integers(-MARGIN, MARGIN), min_size=END, max_size=END)
"""Of each cycle, by how much the time that comes is ahead of the network's."""


@pytest.mark.shows("DRV-7", kind="sweep")
@given(clocks(), AHEAD, AHEAD, st.integers(0, CYCLE_TICKS + MARGIN), st.integers(-2000, 2000))
@settings(max_examples=12, deadline=None)
def test_no_image_lives_longer_than_declared(
    timing: dict[str, Fraction], one: list[int], other: list[int], phase: int, skew: int
) -> None:
    cpus = Cpus(phase_s=Fraction(phase, 10**6), skew_s=Fraction(skew, 10**6))
    scenario = driving(SMALL, END - START, cpus=cpus, **timing)
    frames = [[f for f in of if f.cycle <= LIVE] for of in frames_of(scenario, SMALL)]
    time = [
        [replace(u, ahead_ticks=a) for u, a in zip(updates(SMALL, END, 1), aheads, strict=True)]
        for aheads in (one, other)
    ]
    found = run(scenario, SMALL, inputs(scenario, SMALL, frames=frames, updates=time))
    for fpga in (1, 2):
        assert found.channels[fpga - 1].wave("image").values[-1] == 0
        assert all(life <= SMALL.life_bound_ticks for life in lives(found, fpga))


SLOWEST = RelayTimes(
    clock_hz=10**7, pick_up_s=RELAY.pick_up_s, release_s=SMALL.release_s - Fraction(4, 10**7)
)
"""The declared release less what the stages take to see a pulse."""


def assert_safe(found: Run) -> Fraction:
    """Each contact opens in time, and only what both CPUs command is ever stored. The longest that
    one was closed on no live command."""
    verdict = found.verdict
    assert not verdict.violations, verdict.violations
    sent = [{told_of(f) for f in channel.frames if f.values} for channel in found.channels]
    for channel in found.channels:
        assert {told_of(f) for _, f in channel.stores} <= sent[0] & sent[1]
    return max((each.unbacked_s for each in verdict.closings), default=Fraction(0))


def told_of(frame: Seen) -> tuple[int, ...]:
    return tuple(frame.values[name] for name in ("sequence", "image", "acknowledge"))


IN_ONE_CHANNEL = FAULTS.keys() - {"welded"}
"""A relay that does not release is beyond what is assumed."""


@pytest.mark.shows("DRV-16", kind="sweep")
@given(scenarios(SMALL, 14, kinds=IN_ONE_CHANNEL, most=1))
@settings(max_examples=20, deadline=None)
def test_a_contact_opens_in_the_declared_time_whatever_fails_in_one_channel(
    scenario: Scenario,
) -> None:
    assert_safe(run(scenario, SMALL))


OF_THE_PLANT_S = Fraction(5, 10**6)
"""What a contact's opening may fall short of the declared time: ticks of FPGA and relay."""


@pytest.mark.shows("DRV-16")
def test_the_declared_reaction_time_is_reached() -> None:
    """A train as of FPGA 1 is at the relay for ever. Both clocks and the network's time are as slow
    as they may be, the last frame comes as early as it may, FPGA 2's last pulse rises in the tick
    before its stop, and the relay is as slow as it may be."""
    timing = {"ppm_1": Fraction(-100), "ppm_2": Fraction(-100), "phase_2": Fraction(0)}
    rogue = (fault(f"rogue-1@{LIVE * 12}ms"),)
    scenario = driving(SMALL, END + 1 - START, relay=SLOWEST, faults=rogue, **timing)
    time = [slow_time(), slow_time()]
    frames = ending(scenario, first_to_accept(scenario, 2, time))
    hold = int((scenario.commands[0].start_s + SMALL.cycle_s / 2) / FEMTOSECOND)
    for _ in range(2):
        wires = {"relay.stuck_2": busy(scenario, SMALL, 2, [(hold - 4000 * TICK, hold)])}
        found = run(scenario, SMALL, inputs(scenario, SMALL, frames, time, wires))
        channel = found.channels[1]
        ((dead, _),) = channel.counted("life_out")
        (driven,) = entries(found, 2, 0, State.DRIVE)
        on = int(np.diff(channel.edges.during([driven, dead]))[0])
        hold += on % SMALL.period_ticks * TICK
    assert on % SMALL.period_ticks == 0
    assert found.trace["contact"].values.tolist() == [0, 1, 0]
    short = found.verdict.declared_s - assert_safe(found)
    assert 0 <= short <= OF_THE_PLANT_S


@pytest.mark.shows("DRV-16")
@pytest.mark.slow
@given(scenarios(SMALL, 20, kinds=IN_ONE_CHANNEL, most=1))
@settings(max_examples=4_000, deadline=None)
def test_a_contact_opens_in_the_declared_time_whatever_fails_in_one_channel_for_long(
    scenario: Scenario,
) -> None:
    assert_safe(run(scenario, SMALL))


@pytest.mark.shows("DRV-16", "DRV-17")
@pytest.mark.slow
@given(scenarios(SMALL, 20, odd_clocks()))
@settings(max_examples=1_000, deadline=None)
def test_a_contact_opens_in_the_declared_time_whatever_one_clock_does(scenario: Scenario) -> None:
    assert_safe(run(scenario, SMALL))


@pytest.mark.shows("DRV-7", "DRV-16", kind="sweep")
@given(st.sampled_from((0, 1)), st.integers(0, 1 << 32))
@settings(max_examples=12, deadline=None)
def test_a_channel_drives_on_a_live_image_alone_whatever_its_peer_says(
    board: int, seed: int
) -> None:
    told = surroundings(SMALL, board, 10, seed, open_engine(design(SMALL, board), ENGINE))
    assume("rst" not in told.signals)
    found = open_engine(design(SMALL, board), ENGINE).advance(told.end, told)
    image, states, stored = found["image"], found["states"], found["stored_count"].ticks[1:]
    last_bytes = found["accepted_count"].ticks[1:] - 1 - SMALL.check_ticks
    ends = np.append(image.falling(), found.end)
    for end in ends[image.at(ends - 1) != 0].tolist():
        store = stored[stored < end][-1]
        assert (
            end - last_bytes[last_bytes + SMALL.check_ticks < store - 1][-1]
            <= SMALL.life_bound_ticks
        )
    ticks = np.unique(np.concatenate([image.ticks, image.ticks + 1, states.ticks]))
    ticks = ticks[(ticks > 0) & (ticks < found.end)]
    pulses = found["pulses"]
    for output in range(SMALL.outputs):
        state = states.values >> 3 * output & 7
        drives = Waveform.of(states.ticks, state == State.DRIVE)
        alive = Waveform.of(states.ticks, (state == State.DRIVE) | (state == State.TEST))
        assert (image.at(ticks - 1) >> output & 1 >= drives.at(ticks)).all()
        high = pulses.ticks[pulses.values >> output & 1 == 1]
        assert alive.at(high - 1).all()
