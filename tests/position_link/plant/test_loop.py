"""A link in a closed loop: each fault outside is told by its cause, and the witness agrees."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from position_link.plant.stimuli import SMALL
from railgate.engines import open_engine
from railgate.position_link.loop import loop
from railgate.position_link.plant import FAULTS, Scenario, controls, drive, fault, received
from railgate.position_link.spec import EVEN, Cause, Config
from railgate.waves import Trace

CONFIG = Config(**SMALL, check=EVEN, zero_is_fault=True)
CYCLES = 40

CAUSES = {
    "missing@2.4ms": Cause.TIMEOUT,
    "short@4ms": Cause.SHORT,
    "long@5.6ms": Cause.LONG,
    "early@7.2ms": Cause.EARLY,
    "late@8.8ms": Cause.TIMEOUT | Cause.UNREQUESTED,
    "stuck@10.39ms..11.1ms": Cause.STUCK | Cause.UNREQUESTED,
    "unrequested:14@12ms": Cause.UNREQUESTED,
    "second@13.6ms": Cause.UNREQUESTED,
    "bit-error@15.2ms": Cause.CHECK,
    "unplugged-low@16.8ms": Cause.TIMEOUT,
    "unplugged-high@18.39ms..19.1ms": Cause.STUCK | Cause.UNREQUESTED,
    "noise:40@20ms": None,
    "fault-word@21.6ms": Cause.FAULT_WORD,
    "zero-word@23.2ms": Cause.ZERO_WORD,
    "glitch@24.86ms": Cause(0),
    "drift:2@28ms": Cause.UNSTABLE,
}
"""By the fault: every other cycle has another one. Two rise just before their cycle begins."""


@cache
def run(kind: str, config: Config, cycles: int, *texts: str) -> tuple[Scenario, Trace]:
    scenario = Scenario(faults=tuple(fault(text) for text in texts))
    engine = open_engine(loop(config), kind)
    told = controls(scenario, config, cycles)
    return scenario, engine.advance(told.end, told)


def causes(found: Trace, config: Config, cycle: int) -> int:
    return int(found["causes"].at(1 + cycle * config.cycle_ticks + config.delivery_ticks))


def test_every_kind_of_fault_is_tried() -> None:
    assert {text.split("@")[0].split(":")[0] for text in CAUSES} == set(FAULTS)


@pytest.mark.shows("LNK-4")
@pytest.mark.parametrize("text", CAUSES)
def test_each_fault_is_told_by_its_cause(text: str) -> None:
    _, found = run("cxxrtl", CONFIG, CYCLES, *CAUSES)
    hit = fault(text)
    cycle = int((hit.end_s or hit.start_s) / CONFIG.cycle_s)
    expected = CAUSES[text]
    told = causes(found, CONFIG, cycle)
    assert told != 0 if expected is None else told == expected
    if hit.kind != "drift":
        assert causes(found, CONFIG, cycle - 2) != 0 or cycle == 3
        assert causes(found, CONFIG, cycle + 1) == 0 or hit.kind == "noise"


@pytest.mark.parametrize("kind", ["pysim", "cxxrtl"])
def test_pins_and_radio_unit_of_the_loop_are_those_of_the_step_functions(kind: str) -> None:
    scenario, found = run(kind, CONFIG, CYCLES, *CAUSES)
    assert drive(scenario, CONFIG, CYCLES).first_difference(found.select(["uef", "data"])) is None
    told = received(CONFIG, found)
    assert told.first_difference(found.select(told.signals)) is None


@pytest.mark.shows("LNK-6")
def test_the_radio_unit_has_one_right_frame_a_cycle_with_the_delivered_fields() -> None:
    _, found = run("cxxrtl", CONFIG, CYCLES, *CAUSES)
    assert found["radio.frames"].values.tolist() == list(range(CYCLES + 1))
    assert found["radio.faults"].values.tolist() == [0]
    after = 1 + np.arange(1, CYCLES) * CONFIG.cycle_ticks - 1
    for name in ("word", "status", "age"):
        assert (found[f"radio.{name}"].at(after) == found[name].at(after)).all()
    assert (found["radio.number"].at(after) == found["number"].at(after) % 256).all()


@pytest.mark.slow
def test_the_loop_is_that_of_the_step_functions_at_full_size() -> None:
    config = Config()
    texts = [f"{kind}@{40 * i + 40}ms" for i, kind in enumerate(FAULTS)]
    cycles = 2 * len(FAULTS) + 4
    scenario, found = run("cxxrtl", config, cycles, *texts)
    assert drive(scenario, config, cycles).first_difference(found.select(["uef", "data"])) is None
    told = received(config, found)
    assert told.first_difference(found.select(told.signals)) is None
    assert found["radio.frames"].values[-1] == cycles
