"""Regular periods may break off at every edge, and every limit is met to the tick."""

from itertools import product

import pytest

from odometer.reference import assert_same, reference
from odometer.stimuli import SMALL, Pins, pieces, pulses, trace
from railgate.odometer.model import Model
from railgate.odometer.spec import Config, Flag
from railgate.waves import Trace

FORWARD = pytest.mark.parametrize("forward", [True, False], ids=["forward", "reverse"])


def run(
    config: Config, pins: Pins, strobes: list[tuple[int, int]], end: int, cuts: tuple[int, ...] = ()
) -> Trace:
    """The model's outputs, equal to the reference's, also where the run is cut."""
    signals = {"sensor.0.a": pins.wave(0), "sensor.0.b": pins.wave(1), "strobe": pulses(strobes)}
    stimulus = trace(config, signals, end)
    outputs = Model(config).advance(end, stimulus)
    assert_same(outputs, reference(config, stimulus), config, pins)
    assert_same(pieces(Model(config), stimulus, cuts), outputs, config, pins)
    return outputs


def disturb(at: int, kind: str, forward: bool, gap: int) -> Pins:
    """Eight even periods in which something is wrong at step `at`."""
    pins, rest = Pins(level=0 if forward else 2), gap
    for step in range(32):
        if step == at and kind == "double":
            pins.toggle(rest, 3)
        elif step == at and kind in ("glitch of a", "glitch of b"):
            pins.toggle(2, 1 if kind == "glitch of a" else 2)
            pins.toggle(1, 1 if kind == "glitch of a" else 2)
            rest = gap - 3
        elif step == at and kind == "swap":
            pins.step(rest, not forward)
        elif step == at and kind == "reverse":
            forward = not forward
        elif step == at and kind == "pause":
            rest += 300
        elif step == at and kind == "hurry":
            rest = 1
        elif step == at and kind == "late":
            rest += gap - 2
        elif kind == "brief" and 0 <= step - at <= 2:
            rest = (1, 1, 3 * gap - 2)[step - at]
        pins.step(rest, forward)
        rest = gap
    return pins


KINDS = (
    *("none", "double", "glitch of a", "glitch of b", "swap"),
    *("reverse", "pause", "hurry", "late", "brief"),
)


@pytest.mark.parametrize("kind", KINDS)
@FORWARD
def test_regular_periods_may_break_off_at_every_edge(kind: str, forward: bool) -> None:
    for at, filter_ticks in product(range(32), (0, 1, 4)):
        config = Config(**SMALL, filter_ticks=filter_ticks, window_pulses=5)
        pins = disturb(at, kind, forward, 7)
        run(config, pins, [(41, 1)] * 20, pins.tick + 40, (at * 7 + 3,))


@FORWARD
def test_a_strobe_may_fall_on_any_tick_of_regular_periods(forward: bool) -> None:
    config = Config(**SMALL, filter_ticks=2)
    pins = disturb(-1, "none", forward, 5)
    for at in range(60, 105):
        run(config, pins, [(at, 1), (60, 3)], pins.tick + 20, (at,))


@FORWARD
def test_a_window_grows_old_in_the_midst_of_regular_periods(forward: bool) -> None:
    for gap in range(4, 10):
        pins = Pins(level=0 if forward else 2)
        for _ in range(700 // gap):
            pins.step(gap, forward)
        outputs = run(Config(**SMALL, window_pulses=200), pins, [(690, 1)], 720)
        assert outputs["sensor.0.flags"].values[-1] == Flag.SATURATED | Flag.WINDOW_VOID


def test_a_glitch_counts_from_its_very_tick_on() -> None:
    config = Config(**SMALL, filter_ticks=4)
    for length, at in product((1, 4), range(20, 40)):
        pins = Pins()
        pins.toggle(20, 1)
        pins.toggle(length, 1)
        outputs = run(config, pins, [(at, 1)], 70)
        glitches = outputs["sensor.0.rejected_glitches"].values[-1]
        assert glitches == (at >= 20 + length + 2)


def test_runs_end_only_after_more_than_the_longest_watched_gap() -> None:
    config = Config(**SMALL)
    for more in (-1, 0, 1, 2):
        pins = Pins()
        for _ in range(13):  # ends with a rise of a
            pins.step(7, True)
        pins.toggle(20, 1)
        pins.toggle(config.watch_ticks + more - 20, 1)
        end = pins.tick + 40
        outputs = run(config, pins, [(end - 30, 1)], end)
        flags = Flag(int(outputs["sensor.0.flags"].values[-1]))
        assert (Flag.MISMATCH in flags) == (more <= 0)


def quarters(T: int, phase: int, forward: bool) -> list[int]:
    """Four gaps, the first before a rise of a, for a period of T and a rise of b after `phase`."""
    if forward:  # a up, b up, a down, b down
        return [T - phase - 2, phase, 1, 1]
    return [T - phase, 1, 1, phase - 2]  # a up, b down, a down, b up


@FORWARD
def test_periods_and_phases_are_judged_to_the_tick(forward: bool) -> None:
    config = Config(**SMALL | {"period_bits": 8}, phase_fault_periods=2)
    shortest, watch, most = config.period_min_ticks, config.watch_ticks, config.period_max
    for T in (*range(shortest - 1, shortest + 4), *range(watch - 1, watch + 3), most - 1, most):
        for eighths, more in product((1, 3, 5, 7), (-1, 0, 1)):
            phase = T * eighths // 8 + more
            if not 2 < phase < T - 2:
                continue
            gaps = quarters(T, phase, forward)
            pins = Pins(level=0 if forward else 2)
            for step in range(13):
                pins.step(gaps[step % 4], forward)
            strobes = [(pins.tick + 4, 1), (20, 1)]
            for channels in (1, 1, 2):  # a second rise of a without one of b: is it armed?
                pins.toggle(3, channels)
            run(config, pins, strobes, pins.tick + 40)
