"""Whole runs of short scenarios: from the wheels to the relays."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import cache

import numpy as np
import pytest

from railgate.odometer.host import Verdict
from railgate.position_link.spec import Status
from railgate.unit.faults import Fault
from railgate.unit.route import Route, Side, Stop
from railgate.unit.run import Run, run
from railgate.unit.scenario import Scenario

STOPS = [
    Stop(at_m=50, side=Side.RIGHT, dwell_s=7),
    Stop(at_m=150, side=Side.LEFT, dwell_s=10),
]
SHORT = Scenario(
    name="short",
    route=Route(stops=STOPS, speed_kmh=45),
    ppm_1=Fraction(100),
    ppm_2=Fraction(-100),
)
ARRIVES_S = SHORT.route.calls[1].arrives_s
HALFWAY_S = Fraction(12)


@cache
def ran(*faults: Fault) -> Run:
    return run(replace(SHORT, faults=faults))


def contacts(found: Run, side: Side) -> list[tuple[float, float]]:
    """The spans in which a side's doors were released, s."""
    wave = found.vital.trace["contact"]
    ends = np.append(wave.ticks[1:], found.vital.trace.end)
    closed = (wave.values >> side.value & 1).astype(bool)
    return [(a / 1e15, b / 1e15) for a, b in zip(wave.ticks[closed], ends[closed], strict=True)]


def test_doors_are_released_at_the_platforms_on_their_side_and_closed_before_the_departure() -> (
    None
):
    found = ran()
    for call in SHORT.route.calls:
        here, other = (
            contacts(found, side) for side in (call.stop.side, Side(1 - call.stop.side.value))
        )
        (span,) = here
        assert call.arrives_s + 2 <= span[0] < call.arrives_s + 2.5
        assert call.departs_s - 4 <= span[1] < call.departs_s - 3.8
        assert all(not call.arrives_s < start < call.departs_s for start, _ in other)
    assert not found.vital.verdict.violations


def test_the_truth_is_in_every_interval_of_both_odometers() -> None:
    cycles = ran().cycles
    true_m = (cycles.place_m - SHORT.route.start_m)[:, None]
    speed = cycles.speed_kmh[:, None]
    assert ((cycles.low_kmh <= speed) & (speed <= cycles.high_kmh)).all()
    assert ((cycles.way_low_m <= true_m) & (true_m <= cycles.way_high_m)).all()
    assert (cycles.verdicts == Verdict.ADHERING).all()
    assert np.abs(cycles.way_m - true_m).max() < 0.05


def test_the_position_word_is_the_trains_place() -> None:
    cycles = ran().cycles
    assert (cycles.status == Status.FRESH).all()
    assert np.abs(cycles.word_m - cycles.place_m).max() <= 0.04 * 45 / 3.6 + 0.001


def of_wheel(kind: str, axle: int = 1, start_s: Fraction = HALFWAY_S) -> Fault:
    return Fault(part="wheel", kind=kind, start_s=start_s, axle=axle)


@pytest.mark.parametrize(
    "faults",
    [
        (of_wheel("locked", 1), of_wheel("cable-cut", 2)),
        (of_wheel("cable-cut", 1),),
        (of_wheel("cable-cut", 1), of_wheel("cable-cut", 2)),
    ],
    ids=["a wheel locks, the other's cable is cut", "a cable is cut", "both cables are cut"],
)
def test_neither_a_locked_wheel_nor_a_cut_cable_releases_doors(faults: tuple[Fault, ...]) -> None:
    found = ran(*faults)
    assert contacts(found, Side.LEFT) == []
    assert not found.cycles.stands[found.cycles.times_s > 9].any()


def test_both_cables_cut_at_standstill_release_no_doors_on_the_way() -> None:
    """What the odometers report then is standstill, and it is false."""
    start = Fraction(5)
    found = ran(of_wheel("cable-cut", 1, start), of_wheel("cable-cut", 2, start))
    assert found.cycles.stands[found.cycles.times_s > 6].all()
    moving = (SHORT.route.calls[0].departs_s, ARRIVES_S)
    for side in Side:
        assert all(not (a < moving[1] and b > moving[0]) for a, b in contacts(found, side))


def test_without_position_no_doors_are_released() -> None:
    gone = Fault(part="link", kind="unplugged-low", start_s=HALFWAY_S, end_s=SHORT.seconds)
    found = ran(gone)
    assert contacts(found, Side.LEFT) == []
    assert found.cycles.stands[-1].all()


def test_a_dead_cpu_opens_the_relay_in_the_declared_time() -> None:
    dies = Fraction(5, 2)
    found = ran(Fault(part="vital", kind="cpu-1-dead", start_s=dies))
    ((_, opened),) = contacts(found, Side.RIGHT)
    declared = found.scenario.config.vital.reaction_s
    assert opened - float(dies) < float(declared)
    assert opened < SHORT.route.calls[0].departs_s - 4
    assert contacts(found, Side.LEFT) == []
    assert not found.vital.verdict.violations


def test_the_same_seed_gives_the_same_run() -> None:
    noisy = replace(SHORT, sensor=replace(SHORT.sensor, tooth_error=0.02, jitter_s=1e-6))
    one, again = run(noisy), run(noisy)
    assert one.vital.trace == again.vital.trace
    assert one.odometers[0].outputs == again.odometers[0].outputs
    other = run(replace(noisy, seed=9))
    assert other.odometers[0].outputs != one.odometers[0].outputs
